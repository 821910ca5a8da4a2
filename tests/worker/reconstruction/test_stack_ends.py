"""A short-axis stack ends half a gap beyond its last slices; long-axis slices know better."""

import numpy as np
import pytest

from schemas.options import Options
from schemas.vocabulary import Structure
from worker.evaluation.size import volume_ml
from worker.phantom import SlicingPlan, heart, slice_meshes
from worker.reconstruction.hull import inflated_hull
from worker.reconstruction.normalisation import normalise
from worker.reconstruction.pipeline import reconstruct
from worker.reconstruction.stack_ends import past_the_ends
from worker.reconstruction.stacking import build_stack


def unit_stack(study):
    return normalise(build_stack(study, study.frames[0]))


@pytest.mark.parametrize("inflation", [1.0, 1.05, 1.1])
def test_the_inflated_hull_ends_one_gap_beyond_the_stack(
    concentric_spheres, inflation: float
) -> None:
    stack, frame = unit_stack(concentric_spheres(spacing_mm=12.0, long_axis=False))
    ends = past_the_ends(stack, inflation)
    hull = inflated_hull(np.concatenate([stack.points_unit, ends]), inflation)
    normal = stack.slices[0].normal
    heights = [s.origin @ normal for s in stack.slices if s.outlines]
    reach = hull.triangles_unit.reshape(-1, 3) @ normal
    gap = 12.0 / frame.half_extent_mm
    # The hull is inflated about its own centroid, which the ends move a little.
    assert reach.max() == pytest.approx(max(heights) + gap, abs=0.15 * gap)
    assert reach.min() == pytest.approx(min(heights) - gap, abs=0.15 * gap)


def test_long_axis_slices_show_the_ends_themselves(concentric_spheres) -> None:
    stack, _ = unit_stack(concentric_spheres(long_axis=True))
    assert past_the_ends(stack, 1.1).shape == (0, 3)


def test_one_slice_has_no_gap(concentric_spheres) -> None:
    document = concentric_spheres(long_axis=False).model_dump(mode="json")
    outlined = [s for s in document["frames"][0]["slices"] if s["contours"]]
    document["frames"][0]["slices"] = outlined[:1]
    stack, _ = unit_stack(type(concentric_spheres()).model_validate(document))
    assert past_the_ends(stack, 1.1).shape == (0, 3)


@pytest.mark.slow
def test_volume_of_a_heart_from_short_axis_slices_alone() -> None:
    """Closed at the last slices, it would lose five per cent."""
    truth = heart(0.0).meshes(1.5)
    study = slice_meshes(truth, SlicingPlan(spacing_mm=10.0, long_axis_planes=0)).study
    options = Options(align_slices=False, surfaces=[Structure.LV_ENDO])
    found = reconstruct(study, options).frames[0].surfaces[Structure.LV_ENDO]
    assert volume_ml(found) == pytest.approx(volume_ml(truth[Structure.LV_ENDO]), rel=0.04)
