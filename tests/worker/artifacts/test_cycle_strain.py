"""Area strain of the beating phantom's own motion, against Nanson's formula."""

import numpy as np
import pytest

from schemas.vocabulary import Structure
from tests.worker.artifacts.beating_spheres import ball, tracked
from worker.artifacts.cycle_strain import cycle_strain
from worker.evaluation.aha_segments import LeftVentricle, aha_segments
from worker.evaluation.area_share import vertex_areas_mm2
from worker.evaluation.size import area_cm2
from worker.phantom.beating import PRESETS, BeatingHeart, BeatPreset

LABELS = ["F0", "F1", "F2"]


def test_every_point_grows_as_nansons_formula_says() -> None:
    case = PRESETS[BeatPreset.INFARCT]
    heart = BeatingHeart(case.shape, case.beat)
    times_ms = np.array([0.0, 200.0, heart.beat.cycle.end_systole_ms])
    moving = heart.surfaces(times_ms, edge_mm=2.0)[Structure.LV_EPI]
    rest = moving.frame(0)
    found = cycle_strain(tracked([moving.frame(i) for i in range(3)], LABELS), LABELS, "F0")
    assert found is not None
    # The base is flat, and sharp where it ends: there is no normal at the rim.
    heights_mm = rest.vertices_mm @ heart.pose.rotation[:, 2]
    below = heights_mm < heights_mm.max() - 5.0
    points = rest.vertices_mm[below]
    grown = heart.carried_areas(
        points, heart.rest_normals(Structure.LV_EPI, points), float(times_ms[2])
    )
    truth = 100.0 * (np.linalg.norm(grown, axis=1) - 1.0)
    percent = found.percent[2]
    assert percent is not None
    assert np.abs(percent[below] - truth).mean() < 0.5
    assert np.ptp(truth) > 20.0


def test_its_mean_is_the_surfaces_own_whatever_slides_within() -> None:
    """Vertices moved along a sphere: the spread is of their making, the mean is not."""
    rng = np.random.default_rng(0)
    still, small = ball(24.0), ball(18.0)
    slid = small.vertices_mm + rng.normal(size=small.vertices_mm.shape) * 0.2
    slid *= 18.0 / np.linalg.norm(slid, axis=1, keepdims=True)
    moved = type(small)(slid, small.faces)
    found = cycle_strain(tracked([still, small, moved], LABELS), LABELS, "F0")
    assert found is not None
    _, even, uneven = found.spread()
    assert even is not None
    assert uneven is not None
    assert even.p5 == pytest.approx(even.p95)
    assert uneven.p95 - uneven.p5 > 5.0
    for spread, mesh in ((even, small), (uneven, moved)):
        assert spread.mean == pytest.approx(100.0 * (area_cm2(mesh) / area_cm2(still) - 1.0))
    assert uneven.mean == pytest.approx(even.mean, abs=0.2)


def test_segments_add_up_to_the_whole() -> None:
    rng = np.random.default_rng(1)
    still = ball(24.0)
    moved = type(still)(
        still.vertices_mm * rng.uniform(0.8, 1.0, (len(still.vertices_mm), 1)), still.faces
    )
    found = cycle_strain(tracked([still, moved, still], LABELS), LABELS, "F0")
    assert found is not None
    z, x = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    ventricle = LeftVentricle(np.zeros(3), z, x, apex_mm=-24.1, base_mm=24.1)
    by_segment = found.by_segment(ventricle)
    assert set(by_segment) == set(range(1, 17))
    areas, segment_of = vertex_areas_mm2(still), aha_segments(still.vertices_mm, ventricle)
    total = sum(series[1] * areas[segment_of == n].sum() for n, series in by_segment.items())
    spread = found.spread()[1]
    assert spread is not None
    assert total / areas.sum() == pytest.approx(spread.mean)


def test_frames_that_were_not_tracked_have_none() -> None:
    carried = tracked([ball(24.0), ball(20.0), ball(22.0)], LABELS)
    assert cycle_strain(carried, LABELS, "F7") is None
    found = cycle_strain(carried, ["F0", "X", "F2"], "F2")
    assert found is not None
    assert [one is None for one in found.percent] == [False, True, False]
    assert found.spread()[0].mean == pytest.approx(100.0 * ((24.0 / 22.0) ** 2 - 1.0))
