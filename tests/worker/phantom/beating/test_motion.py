"""Laws of the motion at points all over the heart, and beside it."""

import numpy as np
import pytest

from schemas.vocabulary import Structure
from worker.phantom.analytic_heart import BACKGROUND, LV_WALL, RV_CAVITY
from worker.phantom.beating.instant import Instant
from worker.phantom.beating.motion import carried, carried_back, deformation_gradients


def instants(beating) -> list[Instant]:
    return beating.instants(beating.beat.cycle.frame_times_ms(9))


def somewhere(beating, count: int = 4000) -> np.ndarray:
    """Points of the heart's own frame, in and about the LV and RV, below the base."""
    low, high = (-45.0, -45.0, -70.0), (70.0, 45.0, beating.profile.base_mm)
    return np.random.default_rng(3).uniform(low, high, size=(count, 3))


def tissue_of(beating, points) -> np.ndarray:
    return beating.rest.contains(beating.pose.to_patient(points))


def in_the_wall(beating) -> np.ndarray:
    points = somewhere(beating, 20_000)
    return points[tissue_of(beating, points) == LV_WALL]


def test_the_wall_is_incompressible_point_by_point(beating):
    points = in_the_wall(beating)
    assert len(points) > 1500
    for instant in instants(beating):
        gradients = deformation_gradients(beating.profile, instant, points)
        np.testing.assert_allclose(np.linalg.det(gradients), 1.0, rtol=0.0, atol=1e-12)


def test_the_rv_shrinks_evenly_by_its_share(beating):
    points = somewhere(beating)
    cavity = points[tissue_of(beating, points) == RV_CAVITY]
    for instant in instants(beating):
        gradients = deformation_gradients(beating.profile, instant, cavity)
        np.testing.assert_allclose(np.linalg.det(gradients), instant.rv_share, atol=1e-12)


def test_gradients_are_the_slopes_of_the_motion(beating):
    points = somewhere(beating)
    # A region's edge has two gradients: points within a step of one are left out.
    step = 1e-4
    placed = beating.pose.to_patient(points)
    off_edges = tissue_of(beating, points) != BACKGROUND
    for structure in (Structure.LV_ENDO, Structure.LV_EPI):
        off_edges &= np.abs(beating.rest.implicit_mm(structure, placed)) > 0.01
    assert np.mean(off_edges) > 0.3
    for instant in instants(beating)[1:]:
        profile = beating.profile
        slopes = np.stack(
            [
                (carried(profile, instant, points + v) - carried(profile, instant, points - v))
                / (2.0 * step)
                for v in step * np.eye(3)
            ],
            axis=2,
        )
        found = deformation_gradients(profile, instant, points)
        np.testing.assert_allclose(found[off_edges], slopes[off_edges], atol=2e-6)


def test_the_way_back_is_the_inverse(beating):
    points = somewhere(beating)
    points = points[tissue_of(beating, points) != BACKGROUND]
    for instant in instants(beating):
        there = carried(beating.profile, instant, points)
        np.testing.assert_allclose(carried_back(beating.profile, instant, there), points, atol=1e-9)


def test_regions_stay_apart(beating):
    """Of the outer surface, carried, the wall stays inside and the RV outside."""
    points = somewhere(beating)
    tissue = tissue_of(beating, points)
    profile = beating.profile
    for instant in instants(beating):
        there = carried(profile, instant, points)
        height = points[:, 2]
        outline = np.column_stack([np.sqrt(profile.outer_mm2(height)[0]), points[:, 1] * 0, height])
        angle = np.arctan2(points[:, 1], points[:, 0])
        outline[:, :2] = outline[:, :1] * np.column_stack([np.cos(angle), np.sin(angle)])
        outer = np.linalg.norm(carried(profile, instant, outline)[:, :2], axis=1)
        radius = np.linalg.norm(there[:, :2], axis=1)
        assert (radius < outer)[tissue == LV_WALL].all()
        assert (radius > outer)[tissue == RV_CAVITY].all()


def test_points_on_the_axis_have_a_gradient(healthy):
    apex = np.array([[0.0, 0.0, healthy.profile.apex_mm], [0.0, 0.0, -64.0]])
    (instant,) = healthy.instants(np.array([healthy.beat.cycle.end_systole_ms]))
    gradients = deformation_gradients(healthy.profile, instant, apex)
    np.testing.assert_allclose(np.linalg.det(gradients), 1.0, atol=1e-12)
    np.testing.assert_allclose(carried(healthy.profile, instant, apex)[0], apex[0])


@pytest.mark.parametrize("end", ["apex", "base"])
def test_the_ends_turn_as_asked(healthy, end):
    height = {"apex": healthy.profile.apex_mm, "base": healthy.profile.base_mm}[end]
    point = np.array([[1e-3, 0.0, height]])
    (instant,) = healthy.instants(np.array([healthy.beat.cycle.end_systole_ms]))
    x, y, _ = carried(healthy.profile, instant, point)[0]
    # Counter-clockwise for one who looks from the apex is negative about an axis to the base.
    assert np.degrees(-np.arctan2(y, x)) == pytest.approx({"apex": 8.0, "base": -4.0}[end])
