"""Real hearts, where there are any beside the checkout: the figures that the method promises."""

import json
from pathlib import Path

import numpy as np
import pytest

from intake.formats.guide_points import read_guide_points
from intake.limits import Limits
from schemas.labels import LabelRequest
from schemas.options import Options
from schemas.study import ContourStudy
from schemas.vocabulary import Structure, View
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.function import lv_function
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import euler_number, is_watertight
from worker.labelmaps.reading import read_label_maps
from worker.mesh_file import read_surface
from worker.reconstruction.pipeline import reconstruct

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not DATA.is_dir(), reason="no real hearts beside the checkout"),
]


def study_at(path: str) -> ContourStudy:
    return ContourStudy.model_validate_json((DATA / path).read_bytes())


@pytest.mark.parametrize(
    ("case", "within_mm"), [("bivme-patient1-ed", 0.2), ("bivme-patient1-ed-shifted", 0.3)]
)
def test_surfaces_lie_on_their_references(case: str, within_mm: float) -> None:
    (frame,) = reconstruct(study_at(f"cases/{case}/contours.json"), Options()).frames
    assert set(frame.surfaces) == {Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO}
    for structure, mesh in frame.surfaces.items():
        reference = read_surface(DATA / f"cases/{case}/reference/{structure}.ply")
        assert is_watertight(mesh)
        assert euler_number(mesh) == 2
        assert surface_to_surface(mesh, reference).mean_mm <= within_mm
        assert volume_ml(mesh) == pytest.approx(volume_ml(reference), rel=0.02)


def test_displaced_slices_are_found_where_the_long_axis_crosses_them_and_others_stay() -> None:
    quick = Options.model_validate({"preset": "fast"})
    for case in ("bivme-patient1-ed", "bivme-patient1-ed-shifted"):
        (frame,) = reconstruct(study_at(f"cases/{case}/contours.json"), quick).frames
        shifts_file = DATA / f"cases/{case}/true_shifts_mm.json"
        true_mm = json.loads(shifts_file.read_text()) if shifts_file.exists() else {}
        crossed = [s for s in frame.slices if s.crossings]
        assert len(crossed) >= 11
        for slice_ in crossed:
            assert slice_.shift_deviation_mm is not None
            error = slice_.shift_mm - np.array(true_mm.get(slice_.id, (0.0, 0.0, 0.0)))
            assert np.linalg.norm(error) < 0.2


def test_an_aligned_short_axis_stack_stays_where_it_is() -> None:
    study = study_at("cases/bivme-test1-ed/contours.json")
    (whole,) = study.frames
    alone = whole.model_copy(update={"slices": [s for s in whole.slices if s.view is View.SAX]})
    quick = Options.model_validate({"preset": "fast"})
    (frame,) = reconstruct(study.model_copy(update={"frames": [alone]}), quick).frames
    assert all(not np.any(s.shift_mm) for s in frame.slices)


def test_ejection_fraction_of_a_failing_heart() -> None:
    study = study_at("sunnybrook/SC-HF-I-1.json")
    frames = {f.label: f.surfaces for f in reconstruct(study, Options()).frames}
    volumes = [volume_ml(frames[label][Structure.LV_ENDO]) for label in ("ED", "ES")]
    assert lv_function(*volumes).lv_ejection_fraction_percent == pytest.approx(26.0, abs=2.0)


def test_a_label_map_that_lost_its_scale_is_a_heart_and_not_a_thimble() -> None:
    request = LabelRequest.model_validate({"subject_id": "acdc", "label_scheme": "acdc"})
    file = DATA / "nifti/acdc/patient101_frame01_gt.nii.gz"
    study, warnings = read_label_maps({View.SAX: file}, request, Limits())
    assert any("pixdim" in warning for warning in warnings)
    options = Options(surfaces=[Structure.LV_ENDO])
    mesh = reconstruct(study, options).frames[0].surfaces[Structure.LV_ENDO]
    assert volume_ml(mesh) == pytest.approx(223.0, rel=0.03)


def test_raw_guide_points_give_about_the_heart_that_was_fitted_to_them() -> None:
    """The reference is a model fitted to the same points, about 1 mm from them: no truth."""
    folder = DATA / "bivme_guide_points" / "patient1"
    names = ("GPFile_000.txt", "SliceInfoFile.txt")
    imported = read_guide_points({name: (folder / name).read_bytes() for name in names})
    quick = Options.model_validate({"preset": "fast"})
    (frame,) = reconstruct(imported.study, quick).frames
    for structure, within_mm in ((Structure.LV_ENDO, 2.0), (Structure.RV_ENDO, 3.0)):
        reference = read_surface(DATA / f"cases/bivme-patient1-ed/reference/{structure}.ply")
        mesh = frame.surfaces[structure]
        assert is_watertight(mesh)
        assert surface_to_surface(mesh, reference).mean_mm <= within_mm
        assert volume_ml(mesh) == pytest.approx(volume_ml(reference), rel=0.1)
