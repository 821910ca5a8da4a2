"""RT Structure Sets written: read back alike, and as the standard has them."""

import io

import numpy as np
import pydicom
import pytest
from pydicom import config

from intake.formats.rtstruct import read_rtstruct
from intake.formats.rtstruct_writing import write_rtstruct
from schemas.study import Contour, ContourStudy
from schemas.vocabulary import Axes, Structure, Units, View
from tests.intake.formats.same_study import assert_same_outlines
from tests.intake.formats.test_rtstruct import ring, tilted

TOLERANCE_MM = 1e-4

NOT_EMPTY = (
    *("SOPClassUID", "SOPInstanceUID", "StudyInstanceUID", "SeriesInstanceUID", "Modality"),
    *("FrameOfReferenceUID", "StructureSetLabel", "StructureSetROISequence"),
    *("ROIContourSequence", "RTROIObservationsSequence"),
)
"""Attributes of type 1 of the modules that the object must have (PS3.3, A.19.3)."""

THERE = (
    *("PatientName", "PatientID", "PatientBirthDate", "PatientSex", "StudyDate", "StudyTime"),
    *("ReferringPhysicianName", "StudyID", "AccessionNumber", "SeriesNumber", "OperatorsName"),
    *("Manufacturer", "StructureSetDate", "StructureSetTime", "PositionReferenceIndicator"),
)
"""Attributes of type 2."""


def test_a_study_comes_back(beat: ContourStudy) -> None:
    imported = read_rtstruct(write_rtstruct(beat))
    assert [f.label for f in imported.study.frames] == ["ED", "ES"]
    assert_same_outlines(imported.study, beat, TOLERANCE_MM)
    for ours, theirs in zip(imported.study.frames, beat.frames, strict=True):
        views = [sorted(s.view for s in f.slices if s.contours) for f in (ours, theirs)]
        assert views[0] == views[1]


def test_the_same_study_gives_the_same_bytes(beat: ContourStudy) -> None:
    assert write_rtstruct(beat) == write_rtstruct(beat)


@pytest.mark.parametrize("unit", list(Units))
def test_units_and_axes_become_those_of_dicom(beat: ContourStudy, unit: Units) -> None:
    def scaled(contour: Contour) -> Contour:
        points = np.array(contour.points) * [-1, -1, 1] / unit.millimetres
        return contour.model_copy(update={"points": [tuple(p) for p in points.tolist()]})

    frames = [
        f.model_copy(
            update={
                "slices": [
                    s.model_copy(update={"contours": [scaled(c) for c in s.contours]})
                    for s in f.slices
                ]
            }
        )
        for f in beat.frames
    ]
    other = beat.model_copy(update={"units": unit, "axes": Axes.RAS, "frames": frames})
    assert_same_outlines(read_rtstruct(write_rtstruct(other)).study, beat, TOLERANCE_MM)


def test_holes_open_contours_and_every_structure() -> None:
    points = [tilted(ring(0, 5 + i)).tolist() for i in range(7)]
    contours = [{"structure": s, "points": points[i]} for i, s in enumerate(Structure)]
    contours += [{"structure": "lv_endo", "points": points[6]}]
    opened = {"structure": "lv_epi", "closed": False, "points": ring(0)[:9, [0, 2, 1]].tolist()}
    slices = [
        {"id": "a", "view": "sax", "contours": contours},
        {"id": "b", "view": "lax_3ch", "contours": [opened]},
    ]
    study = ContourStudy.model_validate(
        {
            "subject_id": "s",
            "units": "mm",
            "axes": "LPS",
            "frames": [{"label": "t07", "slices": slices}],
        }
    )
    (data,) = write_rtstruct(study).values()
    kinds = {
        c.ContourGeometricType
        for r in pydicom.dcmread(io.BytesIO(data)).ROIContourSequence
        for c in r.ContourSequence
    }
    assert kinds == {"CLOSED_PLANAR", "CLOSEDPLANAR_XOR", "OPEN_PLANAR"}
    imported = read_rtstruct({"x": data})
    assert_same_outlines(imported.study, study, TOLERANCE_MM)
    assert [s.view for s in imported.study.frames[0].slices] == [View.SAX, View.LAX_3CH]


def test_the_standard_is_kept(beat: ContourStudy, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(config.settings, "_reading_validation_mode", config.RAISE)
    for label, data in write_rtstruct(beat).items():
        dataset = pydicom.dcmread(io.BytesIO(data))
        # Every value is converted, and so checked.
        assert dataset.StructureSetLabel in str(dataset)
        assert dataset.file_meta.TransferSyntaxUID.is_implicit_VR
        assert all(dataset[name].value for name in NOT_EMPTY)
        assert all(name in dataset for name in THERE)
        assert dataset.StructureSetLabel == label
        rois = [roi.ROINumber for roi in dataset.StructureSetROISequence]
        assert rois == [roi.ReferencedROINumber for roi in dataset.ROIContourSequence]
        assert rois == [one.ReferencedROINumber for one in dataset.RTROIObservationsSequence]
        assert len(set(rois)) == len(rois)
        for roi in dataset.StructureSetROISequence:
            assert roi.ReferencedFrameOfReferenceUID == dataset.FrameOfReferenceUID
            assert "ROIGenerationAlgorithm" in roi
        for roi in dataset.ROIContourSequence:
            for item in roi.ContourSequence:
                assert len(item.ContourData) == 3 * item.NumberOfContourPoints
                assert all(len(str(x)) <= 16 for x in item.ContourData)
        ours = {dataset[n].value for n in NOT_EMPTY[1:4]} | {dataset.FrameOfReferenceUID}
        assert len(ours) == 4
        assert all(pydicom.uid.UID(uid).is_valid for uid in ours)
        assert str(dataset.PatientName) == ""
