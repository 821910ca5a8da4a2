"""Errors against closed form, and against the project's own measures."""

import numpy as np
import pytest
import trimesh

from benchmarks.errors import errors, residual_mm
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.thirds import Region, thirds
from worker.surface_mesh import SurfaceMesh

UP = np.array([0.0, 0.0, 1.0])


def ball(radius_mm: float) -> SurfaceMesh:
    shape = trimesh.creation.icosphere(subdivisions=5, radius=radius_mm)
    return SurfaceMesh(np.asarray(shape.vertices, float), np.asarray(shape.faces, np.int64))


def test_a_larger_ball_is_off_by_the_same_everywhere() -> None:
    truth, found = ball(30.0), ball(31.0)
    parts = errors(found, truth, thirds(truth, UP))
    for error in parts.values():
        assert error.mean_mm == pytest.approx(1.0, abs=0.02)
        assert error.rms_mm == pytest.approx(1.0, abs=0.02)
        assert error.max_mm == pytest.approx(1.0, abs=0.05)
    assert parts[None].volume_error_percent == pytest.approx(100.0 * ((31 / 30) ** 3 - 1.0))


def test_the_whole_is_what_the_project_measures() -> None:
    truth, small = ball(30.0), ball(29.0)
    found = SurfaceMesh(small.vertices_mm + np.array([0.5, 0.0, 1.0]), small.faces)
    whole = errors(found, truth, thirds(truth, UP))[None]
    known = surface_to_surface(found, truth)
    assert whole.mean_mm == pytest.approx(known.mean_mm)
    assert whole.rms_mm == pytest.approx(known.rms_mm)
    assert whole.p95_mm == pytest.approx(known.hausdorff95_mm)
    assert whole.max_mm == pytest.approx(known.hausdorff_mm)


def test_a_shift_along_the_axis_is_seen_at_its_ends() -> None:
    truth = ball(30.0)
    found = SurfaceMesh(truth.vertices_mm + 2.0 * UP, truth.faces)
    parts = errors(found, truth, thirds(truth, UP))
    assert parts[Region.APEX].mean_mm > 2.0 * parts[Region.MID].mean_mm
    assert parts[Region.BASE].mean_mm == pytest.approx(parts[Region.APEX].mean_mm, rel=0.1)
    apex, base = (parts[r].volume_error_percent for r in (Region.APEX, Region.BASE))
    assert apex is not None
    assert base is not None
    assert apex < 0.0 < base
    assert parts[None].volume_error_percent == pytest.approx(0.0, abs=1e-9)


def test_a_surface_that_misses_a_region_is_judged_there_by_the_truth() -> None:
    truth = ball(30.0)
    above = SurfaceMesh(ball(5.0).vertices_mm + 25.0 * UP, ball(5.0).faces)
    apex = errors(above, truth, thirds(truth, UP))[Region.APEX]
    assert apex.max_mm == pytest.approx(50.0, abs=0.1)
    assert apex.volume_error_percent == pytest.approx(-100.0)


def test_an_open_surface_has_no_volume() -> None:
    truth = ball(30.0)
    torn = SurfaceMesh(truth.vertices_mm, truth.faces[1:])
    assert errors(torn, truth, thirds(truth, UP))[None].volume_error_percent is None


def test_residual_of_nothing_found_is_the_displacement() -> None:
    true = {"a": np.array([3.0, 0.0, 0.0]), "b": np.array([0.0, 4.0, 0.0])}
    both = frozenset({"a", "b"})
    assert residual_mm({}, true, both) == pytest.approx(np.sqrt(12.5))
    assert residual_mm(true, true, both) == 0.0
    assert residual_mm({"a": true["a"]}, true, both) == pytest.approx(np.sqrt(8.0))
    assert residual_mm({}, true, frozenset({"a"})) == 3.0
