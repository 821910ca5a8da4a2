"""The unit frame: there and back is identity, and it turns with the heart."""

import numpy as np
from scipy.spatial.transform import Rotation

from worker.reconstruction.normalisation import normalise
from worker.reconstruction.stacking import build_stack


def test_mm_to_unit_to_mm_is_identity(concentric_spheres) -> None:
    study = concentric_spheres()
    stack = build_stack(study, study.frames[0])
    _, frame = normalise(stack)
    points_mm = np.random.default_rng(0).uniform(-500, 500, (100, 3))
    np.testing.assert_allclose(frame.to_mm(frame.to_unit(points_mm)), points_mm, atol=1e-9)
    np.testing.assert_allclose(
        frame.displacement_to_mm(frame.to_unit(points_mm) - frame.to_unit(points_mm[:1])),
        points_mm - points_mm[:1],
        atol=1e-9,
    )


def test_contours_fill_the_unit_cube(concentric_spheres) -> None:
    study = concentric_spheres(epi_mm=35.0)
    unit_stack, frame = normalise(build_stack(study, study.frames[0]))
    assert np.abs(unit_stack.points_unit).max() <= 1.0 + 1e-9
    assert abs(frame.half_extent_mm - 35.0) < 0.5


def test_slices_lift_and_drop(concentric_spheres) -> None:
    study = concentric_spheres()
    stack = build_stack(study, study.frames[0])
    unit_stack, frame = normalise(stack)
    for given, unit in zip(stack.slices, unit_stack.slices, strict=True):
        np.testing.assert_allclose(unit.axes @ unit.axes.T, np.eye(2), atol=1e-12)
        np.testing.assert_allclose(unit.axes @ unit.normal, 0.0, atol=1e-12)
        for structure, outlines in given.outlines.items():
            for outline, found in zip(outlines, unit.outlines[structure], strict=True):
                back = frame.to_mm(unit.lift(found.points))
                np.testing.assert_allclose(back, outline.points_mm, atol=1e-9)


def test_a_study_moved_and_turned_is_the_same_in_unit_coordinates(concentric_spheres) -> None:
    turn = Rotation.from_rotvec([0.4, -1.1, 2.0]).as_matrix()
    moved = {5: (7.0, 3.0)}  # breaks the sphere's symmetry, which leaves axes undefined
    plain = concentric_spheres(displacements=moved, centre=(0.0, 0.0, 0.0))
    turned = concentric_spheres(displacements=moved, centre=(90.0, 80.0, -70.0), rotation=turn)
    a, frame_a = normalise(build_stack(plain, plain.frames[0]))
    b, frame_b = normalise(build_stack(turned, turned.frames[0]))
    np.testing.assert_allclose(a.points_unit, b.points_unit, atol=1e-9)
    np.testing.assert_allclose(frame_a.rotation, frame_b.rotation @ turn, atol=1e-9)
    for left, right in zip(a.slices, b.slices, strict=True):
        np.testing.assert_allclose(left.axes, right.axes, atol=1e-9)
        np.testing.assert_allclose(left.origin, right.origin, atol=1e-9)


def test_axes_are_right_handed(concentric_spheres) -> None:
    study = concentric_spheres()
    _, frame = normalise(build_stack(study, study.frames[0]))
    assert np.linalg.det(frame.rotation) > 0.999
