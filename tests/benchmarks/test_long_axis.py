"""The axis by which regions are told."""

import pytest

from benchmarks.long_axis import apex_to_base
from schemas.vocabulary import Structure
from worker.phantom import SlicingPlan, heart, slice_meshes
from worker.reconstruction.stacking import build_stack


@pytest.mark.parametrize("flipped", [False, True])
def test_the_axis_points_from_apex_to_base_however_normals_point(flipped: bool) -> None:
    truth = heart(0.0).meshes(3.0)
    study = slice_meshes(truth, SlicingPlan(spacing_mm=15.0)).study
    if flipped:
        data = study.model_dump()
        for slice_ in data["frames"][0]["slices"]:
            slice_["normal"] = [-x for x in slice_["normal"]]
        study = type(study).model_validate(data)
    axis = apex_to_base(build_stack(study, study.frames[0]), truth)
    endo, epi = (truth[s].vertices_mm @ axis for s in (Structure.LV_ENDO, Structure.LV_EPI))
    # The wall covers the apex, and both surfaces end at the base.
    assert endo.min() - epi.min() > 5.0
    assert abs(endo.max() - epi.max()) < 0.5
