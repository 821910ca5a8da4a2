"""An affine motion of outlines is found, and a field moved by it is the same field elsewhere."""

import numpy as np
import pytest
import torch

from schemas.options import NetworkOptions
from schemas.vocabulary import Structure
from worker.reconstruction.affine_motion import STILL, AffineMotion, affine_motion
from worker.reconstruction.network import TissueField

MOTION = AffineMotion(
    np.array([[0.93, 0.02, 0.0], [-0.02, 0.95, 0.01], [0.0, 0.0, 0.9]]),
    np.array([0.02, -0.01, 0.03]),
)


def shell(radii: tuple[float, float, float]) -> np.ndarray:
    directions = np.random.default_rng(3).normal(size=(3000, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True) * radii


@pytest.fixture
def outlines() -> dict[Structure, np.ndarray]:
    return {
        Structure.LV_ENDO: shell((0.4, 0.3, 0.7)),
        Structure.RV_ENDO: shell((0.5, 0.2, 0.6)) + np.array([0.7, 0.1, 0.0]),
    }


def test_a_known_motion_of_the_same_points_is_found(outlines) -> None:
    after = {structure: MOTION.apply(points) for structure, points in outlines.items()}
    found = affine_motion(outlines, after)
    for structure, points in outlines.items():
        left = np.linalg.norm(found.apply(points) - after[structure], axis=1)
        before = np.linalg.norm(points - after[structure], axis=1)
        assert left.mean() < 0.25 * before.mean()


def test_what_did_not_move_stays(outlines) -> None:
    found = affine_motion(outlines, outlines)
    np.testing.assert_allclose(found.matrix, np.eye(3), atol=1e-9)
    np.testing.assert_allclose(found.offset, 0.0, atol=1e-9)


def test_frames_without_a_structure_in_common_stay_in_place(outlines) -> None:
    assert affine_motion(outlines, {Structure.EPI: shell((1.0, 1.0, 1.0))}) is STILL


def test_a_motion_and_its_inverse_are_nothing(outlines) -> None:
    points = outlines[Structure.LV_ENDO]
    np.testing.assert_allclose(MOTION.inverse().apply(MOTION.apply(points)), points, atol=1e-12)


def test_a_moved_field_says_at_a_moved_point_what_it_said_at_the_point() -> None:
    field = TissueField(3, NetworkOptions(), torch.Generator().manual_seed(0))
    kept = {name: values.clone() for name, values in field.state_dict().items()}
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (500, 3))
    there = field.moved(MOTION)
    with torch.no_grad():
        before = field(torch.as_tensor(points, dtype=torch.float32))
        after = there(torch.as_tensor(MOTION.apply(points), dtype=torch.float32))
    torch.testing.assert_close(after, before, atol=2e-5, rtol=0.0)
    for name, values in field.state_dict().items():
        torch.testing.assert_close(values, kept[name], atol=0.0, rtol=0.0)
