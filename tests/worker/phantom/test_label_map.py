"""A phantom written as label maps and read back is the phantom."""

from pathlib import Path

import nibabel
import numpy as np
import pytest

from intake.limits import Limits
from intake.study import admit
from schemas.labels import LabelRequest, LabelScheme, TissueLabels
from schemas.options import Options
from schemas.study import ContourStudy
from schemas.vocabulary import Structure, View
from worker.labelmaps.reading import read_label_maps
from worker.phantom.analytic_heart import Heart, heart
from worker.phantom.label_map import write_label_maps

RAS_TO_LPS = np.array([-1.0, -1.0, 1.0])


def read_back(
    files: dict[View, Path], scheme: LabelScheme | TissueLabels
) -> tuple[ContourStudy, list[str]]:
    request = LabelRequest(subject_id="phantom", label_scheme=scheme)
    return read_label_maps(files, request, Limits())


def off_mm(study: ContourStudy, frame: int, solid: Heart, structure: Structure) -> np.ndarray:
    points = [
        contour.points
        for slice_ in study.frames[frame].slices
        for contour in slice_.contours
        if contour.structure is structure
    ]
    return np.abs(solid.implicit_mm(structure, np.concatenate(points) * RAS_TO_LPS))


@pytest.mark.parametrize("scheme", LabelScheme)
def test_every_scheme_reads_back_on_the_surfaces(scheme: LabelScheme, tmp_path: Path) -> None:
    solid = heart()
    files = write_label_maps(solid, tmp_path, scheme)
    assert set(files) == {View.SAX, View.LAX_4CH, View.LAX_2CH, View.LAX_3CH}
    study, warnings = read_back(files, scheme)
    assert warnings == []
    assert admit(study, Options()) == []
    for structure in (Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO):
        assert off_mm(study, 0, solid, structure).mean() < 0.3


def test_an_explicit_scheme_and_a_stack_alone(tmp_path: Path) -> None:
    scheme = TissueLabels(lv_cavity=[40], lv_wall=[30], rv_cavity=[20])
    files = write_label_maps(heart(), tmp_path, scheme, lax=())
    assert list(files) == [View.SAX]
    voxels = np.asarray(nibabel.load(files[View.SAX]).dataobj)
    assert np.unique(voxels).tolist() == [0, 20, 30, 40]
    assert read_back(files, scheme)[0].frames[0].slices


def test_volume_of_the_finest_stack_is_the_closed_form(tmp_path: Path) -> None:
    solid = heart()
    files = write_label_maps(
        solid, tmp_path, LabelScheme.MNMS, spacing_mm=2.0, pixel_mm=1.0, lax=()
    )
    image = nibabel.load(files[View.SAX])
    cavity_ml = (np.asarray(image.dataobj) == 1).sum() * np.abs(np.linalg.det(image.affine)) / 1000
    assert cavity_ml == pytest.approx(solid.closed_form_volume_ml(Structure.LV_ENDO), rel=0.01)


def test_later_frames_make_a_cine(tmp_path: Path) -> None:
    files = write_label_maps(
        heart(), tmp_path, LabelScheme.ACDC, later=(heart(0.5), heart(1.0)), time_step_ms=150.0
    )
    study, _ = read_back(files, LabelScheme.ACDC)
    assert [f.time_ms for f in study.frames] == [0.0, 150.0, 300.0]
    assert off_mm(study, 2, heart(1.0), Structure.LV_ENDO).mean() < 0.3


def test_files_are_the_same_bytes_each_time(tmp_path: Path) -> None:
    first, second = tmp_path / "a", tmp_path / "b"
    first.mkdir()
    second.mkdir()
    one = write_label_maps(heart(), first, LabelScheme.ACDC)
    two = write_label_maps(heart(), second, LabelScheme.ACDC)
    assert {v: p.read_bytes() for v, p in one.items()} == {
        v: p.read_bytes() for v, p in two.items()
    }
