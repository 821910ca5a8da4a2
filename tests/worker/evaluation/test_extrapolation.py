"""Which end is which, and what contours show of it."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from schemas.vocabulary import Structure, View
from worker.evaluation.extrapolation import apex_to_base, slice_gap_mm, surface_ends
from worker.evaluation.support import AlignedOutline, distance_to_outlines_mm
from worker.surface_mesh import SurfaceMesh

ENDO = Structure.LV_ENDO
FAR_MM = np.array([120.0, -340.0, 900.0])
TURN = Rotation.from_rotvec([0.5, -1.0, 0.3]).as_matrix()


def ring(z_mm: float, radius_mm: float, reverse: bool = False) -> AlignedOutline:
    turn = np.linspace(0.0, 2 * np.pi, 60, endpoint=False)[:: -1 if reverse else 1]
    points = [radius_mm * np.cos(turn), radius_mm * np.sin(turn), np.full_like(turn, z_mm)]
    return AlignedOutline(f"{z_mm}", View.SAX, np.stack(points, axis=1) @ TURN.T + FAR_MM, True)


def arch(low_mm: float, high_mm: float) -> AlignedOutline:
    """An open outline that goes down to `low_mm` and ends at `high_mm` on both sides."""
    points = [[-10.0, 0.0, high_mm], [0.0, 0.0, low_mm], [10.0, 0.0, high_mm]]
    return AlignedOutline("lax", View.LAX_4CH, np.array(points) @ TURN.T + FAR_MM, False)


CONE = [ring(z_mm, 8.0 + 0.5 * z_mm, reverse=bool(k % 2)) for k, z_mm in enumerate((0, 8, 16, 24))]


def placed(sphere: SurfaceMesh, scale_mm: float, z_mm: float) -> SurfaceMesh:
    middle = np.array([0.0, 0.0, z_mm])
    vertices = sphere.vertices_mm / 20.0 * scale_mm + middle
    return SurfaceMesh(vertices @ TURN.T + FAR_MM, sphere.faces)


def test_the_base_is_where_short_axis_outlines_are_wider() -> None:
    axis = apex_to_base({ENDO: CONE})
    np.testing.assert_allclose(axis, TURN[:, 2], atol=1e-9)
    flipped = [ring(-z_mm, 8.0 + 0.5 * z_mm) for z_mm in (0, 8, 16, 24)]
    np.testing.assert_allclose(apex_to_base({ENDO: flipped}), -TURN[:, 2], atol=1e-9)


def test_the_base_is_where_long_axis_outlines_end_whatever_the_widths() -> None:
    tapering_up = [ring(z_mm, 30.0 - 0.5 * z_mm) for z_mm in (0, 8, 16, 24)]
    axis = apex_to_base({ENDO: [*tapering_up, arch(-6.0, 30.0)]})
    np.testing.assert_allclose(axis, TURN[:, 2], atol=1e-9)


def test_without_short_axis_slices_there_is_no_telling() -> None:
    assert apex_to_base({ENDO: [arch(-6.0, 30.0)]}) is None
    assert apex_to_base({}) is None


def test_the_gap_is_the_median_between_slices_that_show_the_surface() -> None:
    axis = TURN[:, 2]
    assert slice_gap_mm(axis, CONE) == pytest.approx(8.0)
    assert slice_gap_mm(axis, [*CONE, arch(-6.0, 30.0)]) == pytest.approx(8.0)
    assert slice_gap_mm(axis, CONE[:1]) is None


@pytest.mark.parametrize(
    ("low_mm", "high_mm", "apex", "base"),
    [(-8.0, 32.0, True, True), (-8.0, 25.0, True, False), (-1.0, 32.0, False, True)],
)
def test_an_end_is_shown_by_a_contour_that_goes_half_its_height(
    sphere: SurfaceMesh, low_mm: float, high_mm: float, apex: bool, base: bool
) -> None:
    mesh = placed(sphere, 20.0, 12.0)  # from -8 to 32 mm: 8 mm beyond either end slice
    outlines = [*CONE, arch(low_mm, high_mm)]
    support_mm = distance_to_outlines_mm(mesh.vertices_mm, outlines)
    ends = surface_ends(mesh, support_mm, TURN[:, 2], outlines)
    assert ends is not None
    assert [end.height_mm for end in ends] == pytest.approx([8.0, 8.0], abs=0.05)
    assert [end.on_long_axis for end in ends] == [apex, base]


def test_a_surface_that_ends_within_its_slices_has_no_height(sphere: SurfaceMesh) -> None:
    mesh = placed(sphere, 5.0, 12.0)
    support_mm = distance_to_outlines_mm(mesh.vertices_mm, CONE)
    ends = surface_ends(mesh, support_mm, TURN[:, 2], CONE)
    assert ends is not None
    assert [(end.height_mm, end.support_max_mm) for end in ends] == [(0.0, 0.0), (0.0, 0.0)]


def test_a_surface_on_no_short_axis_slice_has_no_ends(sphere: SurfaceMesh) -> None:
    only = [arch(-6.0, 30.0)]
    mesh = placed(sphere, 20.0, 12.0)
    support_mm = distance_to_outlines_mm(mesh.vertices_mm, only)
    assert surface_ends(mesh, support_mm, TURN[:, 2], only) is None
