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


def test_outlines_are_carried_half_as_far_as_long_axis_slices_show(concentric_spheres) -> None:
    stack, frame = unit_stack(concentric_spheres(long_axis=True))
    normal = stack.slices[0].normal
    carried = past_the_ends(stack, 1.1) @ normal * frame.half_extent_mm
    own = [(s.origin @ normal * frame.half_extent_mm, s.outlines) for s in stack.slices[:10]]
    middle = np.mean([s.origin @ normal for s in stack.slices[10:]]) * frame.half_extent_mm
    for structure, radius_mm in ((Structure.LV_ENDO, 25.0), (Structure.LV_EPI, 35.0)):
        heights = [height for height, outlines in own if structure in outlines]
        for end, tip in (
            (min(heights), middle - radius_mm),
            (max(heights), middle + radius_mm),
        ):
            assert np.abs(carried - 0.5 * (end + tip)).min() < 0.1
    assert carried.max() < middle + 35.0
    assert carried.min() > middle - 35.0


def test_what_long_axis_slices_do_not_show_is_not_carried(concentric_spheres) -> None:
    """The outer sphere ends within the stack for all that they say."""
    document = concentric_spheres(long_axis=True).model_dump(mode="json")
    for slice_ in document["frames"][0]["slices"]:
        if slice_["view"] != "sax":
            slice_["contours"] = [c for c in slice_["contours"] if c["structure"] == "lv_endo"]
    stack, _ = unit_stack(type(concentric_spheres()).model_validate(document))
    count = sum(
        len(o.points)
        for s in stack.slices
        if s.view == "sax" and Structure.LV_ENDO in s.outlines
        for o in s.outlines[Structure.LV_ENDO]
    )
    assert 0 < len(past_the_ends(stack, 1.1)) < count


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


@pytest.mark.slow
def test_one_long_axis_slice_does_not_flatten_the_base() -> None:
    """A hull of the outlines alone cuts the rounded base to a wedge, and loses two per cent."""
    truth = heart(0.0).meshes(1.5)
    study = slice_meshes(truth, SlicingPlan(long_axis_planes=1)).study
    found = reconstruct(study, Options()).frames[0].surfaces
    for structure, mesh in found.items():
        assert volume_ml(mesh) == pytest.approx(volume_ml(truth[structure]), rel=0.01)
