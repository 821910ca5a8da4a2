"""The open base: found where the evidence says, cut clean."""

import numpy as np
import pytest

from schemas.problem import InputError
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.evaluation.topology import boundary_loop_count, is_watertight
from worker.reconstruction.base_plane import BasePlane, cut_open, find_base
from worker.reconstruction.isosurface import isosurfaces
from worker.reconstruction.stacking import build_stack
from worker.surface_mesh import SurfaceMesh

ENDO = Structure.LV_ENDO


def half_ellipsoid_study(*, open_lax: bool) -> ContourStudy:
    """A half ellipsoid: apex at z = -60, base at z = 0, sliced every 10 mm."""
    t = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    slices = []
    for k, z in enumerate(range(-50, 1, 10)):
        r = 25.0 * np.sqrt(1.0 - (z / 60.0) ** 2)
        ring = np.column_stack([r * np.cos(t), r * np.sin(t), np.full_like(t, z)])
        slices.append(
            {
                "id": f"sax-{k}",
                "view": "sax",
                "contours": [{"structure": "lv_endo", "points": ring.tolist()}],
            }
        )
    if open_lax:
        u = np.linspace(np.pi, 2.0 * np.pi, 50)
        for view, axis in (("lax_4ch", 0), ("lax_2ch", 1)):
            arc = np.zeros((50, 3))
            arc[:, axis], arc[:, 2] = 25.0 * np.cos(u), 60.0 * np.sin(u) + 4.0
            contour = {"structure": "lv_endo", "closed": False, "points": arc.tolist()}
            slices.append({"id": view, "view": view, "contours": [contour]})
    return ContourStudy.model_validate(
        {
            "subject_id": "half",
            "units": "mm",
            "axes": "LPS",
            "frames": [{"label": "ED", "slices": slices}],
        }
    )


def test_valve_points_of_open_outlines_come_first() -> None:
    study = half_ellipsoid_study(open_lax=True)
    base = find_base(build_stack(study, study.frames[0]), ENDO)
    np.testing.assert_allclose(base.toward_base, [0.0, 0.0, 1.0], atol=1e-6)
    assert base.origin_mm[2] == pytest.approx(4.0, abs=1e-6)


def test_else_the_most_basal_short_axis_slice() -> None:
    study = half_ellipsoid_study(open_lax=False)
    base = find_base(build_stack(study, study.frames[0]), ENDO)
    np.testing.assert_allclose(base.toward_base, [0.0, 0.0, 1.0], atol=1e-6)
    assert base.origin_mm[2] == pytest.approx(0.0, abs=1e-6)


def test_without_either_the_remedy_is_named() -> None:
    study = half_ellipsoid_study(open_lax=False)
    with pytest.raises(InputError, match='"base": "closed"'):
        find_base(build_stack(study, study.frames[0]), Structure.RV_ENDO)


def test_a_cut_sphere_is_open_along_one_loop() -> None:
    (ball,) = isosurfaces(
        lambda p: (20.0 - np.linalg.norm(p, axis=1))[:, None],
        np.full(3, -25.0),
        np.full(3, 25.0),
        2.0,
    )
    mesh = SurfaceMesh(ball.vertices, ball.faces)
    opened = cut_open(mesh, BasePlane(np.array([0.0, 0.0, 5.0]), np.array([0.0, 0.0, 1.0])))
    assert not is_watertight(opened)
    assert boundary_loop_count(opened) == 1
    assert opened.vertices_mm[:, 2].max() == pytest.approx(5.0)
    assert opened.vertices_mm[:, 2].min() == pytest.approx(mesh.vertices_mm[:, 2].min())


@pytest.mark.parametrize("open_lax", [True, False])
@pytest.mark.parametrize("flipped", [True, False])
def test_a_single_short_axis_slice_does_not_turn_the_base_over(
    open_lax: bool, flipped: bool
) -> None:
    """Whichever way its normal points; open outlines say it themselves, closed ones by tapering."""
    document = half_ellipsoid_study(open_lax=True).model_dump(mode="json")
    slices = document["frames"][0]["slices"]
    one, *long_axis = slices[3], *(s for s in slices if s["view"] != "sax")
    one["origin"] = one["contours"][0]["points"][0]
    one["normal"] = [0.0, 0.0, -1.0 if flipped else 1.0]
    for slice_ in long_axis:
        slice_["contours"][0]["closed"] = not open_lax
    document["frames"][0]["slices"] = [one, *long_axis]
    study = ContourStudy.model_validate(document)
    base = find_base(build_stack(study, study.frames[0]), ENDO)
    np.testing.assert_allclose(base.toward_base, [0.0, 0.0, 1.0], atol=1e-6)
    assert base.origin_mm[2] == pytest.approx(4.0 if open_lax else -20.0, abs=1e-6)
