"""The example request is valid, small, and what the project's own commands make of the phantom."""

from pathlib import Path

import numpy as np
import pytest

from intake.contour_request import read_contour_request
from worker.evaluation.distance import points_to_surface_mm
from worker.phantom import SlicingPlan, heart, slice_meshes
from worker.phantom.outline import enclosed_mm2

EXAMPLE = Path(__file__).parents[1] / "examples" / "contours.json"


def test_the_example_is_admitted_without_warning_and_small():
    _, warnings = read_contour_request(EXAMPLE.read_bytes())
    assert warnings == []
    assert EXAMPLE.stat().st_size < 60_000


def test_the_example_is_what_the_phantom_gives():
    request, _ = read_contour_request(EXAMPLE.read_bytes())
    truth = heart().meshes()
    plan = SlicingPlan(spacing_mm=10.0, point_spacing_mm=4.0)
    (given,), (made,) = request.study.frames, slice_meshes(truth, plan).study.frames
    assert [(s.id, s.view, s.absent) for s in given.slices] == [
        (s.id, s.view, s.absent) for s in made.slices
    ]
    for one, other in zip(given.slices, made.slices, strict=True):
        for contour, again in zip(one.contours, other.contours, strict=True):
            points = np.array(contour.points)
            assert contour.structure is again.structure
            assert len(contour.points) == len(again.points)
            # Where along the outline it starts depends on the order of the mesh's vertices.
            assert enclosed_mm2(points) == pytest.approx(
                enclosed_mm2(np.array(again.points)), rel=0.01
            )
            assert points_to_surface_mm(points, truth[contour.structure]).max() < 1e-3
