"""A contour study as DICOM RT Structure Sets (PS3.3, A.19), one for each frame."""

import io
from collections import Counter
from typing import TYPE_CHECKING

from schemas.study import Contour, ContourStudy, Frame
from schemas.vocabulary import Axes, Structure, View

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

_STORAGE = "1.2.840.10008.5.1.4.1.1.481.3"
_LABEL_LETTERS = 16
_DECIMALS = 4
_COLOURS = {
    Structure.LV_ENDO: [220, 50, 47],
    Structure.LV_EPI: [38, 139, 210],
    Structure.RV_ENDO: [133, 153, 0],
    Structure.RV_EPI: [108, 113, 196],
    Structure.EPI: [181, 137, 0],
}


def write_rtstruct(study: ContourStudy) -> dict[str, bytes]:
    """The bytes of a file for each frame, by its label. LPS mm, Implicit VR Little Endian.

    A region is one structure in one view, and is called so; `read_rtstruct` reads them back.
    Lost are `absent`, and planes without contours: the standard has no place for them. Contours
    refer to no images, and all files are of one frame of reference. The patient's ID is the
    study's subject, other identity is left empty. The same study gives the same bytes.
    """
    return {
        frame.label: _file(study, frame, number) for number, frame in enumerate(study.frames, 1)
    }


def _file(study: ContourStudy, frame: Frame, number: int) -> bytes:
    from pydicom.dataset import FileMetaDataset
    from pydicom.filewriter import dcmwrite
    from pydicom.uid import ImplicitVRLittleEndian

    dataset = _header(study, frame, number)
    _add_regions(dataset, study, frame)
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.MediaStorageSOPClassUID = dataset.SOPClassUID
    dataset.file_meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID
    dataset.file_meta.TransferSyntaxUID = ImplicitVRLittleEndian
    stream = io.BytesIO()
    dcmwrite(stream, dataset, enforce_file_format=True)
    return stream.getvalue()


def _header(study: ContourStudy, frame: Frame, number: int) -> "Dataset":
    from pydicom.dataset import Dataset
    from pydicom.uid import generate_uid

    # Type 2 attributes must be there and may be empty (PS3.5, 7.4).
    text, subject = study.model_dump_json(), study.subject_id
    dataset = Dataset()
    dataset.SOPClassUID = _STORAGE
    dataset.SOPInstanceUID = generate_uid(entropy_srcs=[text, frame.label])
    dataset.StudyInstanceUID = generate_uid(entropy_srcs=[text, "study"])
    dataset.SeriesInstanceUID = generate_uid(entropy_srcs=[text, "series"])
    dataset.FrameOfReferenceUID = generate_uid(entropy_srcs=[text, "frame of reference"])
    dataset.PatientID = subject
    for empty in ("PatientName", "PatientBirthDate", "PatientSex", "StudyDate", "StudyTime"):
        setattr(dataset, empty, "")
    for empty in ("ReferringPhysicianName", "StudyID", "AccessionNumber", "OperatorsName"):
        setattr(dataset, empty, "")
    dataset.PositionReferenceIndicator = ""
    dataset.Modality = "RTSTRUCT"
    dataset.Manufacturer = "neuralmri"
    dataset.SeriesNumber = 1
    dataset.InstanceNumber = number
    dataset.StructureSetLabel = frame.label[:_LABEL_LETTERS]
    dataset.StructureSetName = frame.label
    dataset.StructureSetDate = dataset.StructureSetTime = ""
    return dataset


def _add_regions(dataset: "Dataset", study: ContourStudy, frame: Frame) -> None:
    from pydicom.dataset import Dataset

    regions: dict[tuple[Structure, View], list[Dataset]] = {}
    for slice_ in frame.slices:
        rings = Counter(c.structure for c in slice_.contours if c.closed)
        for contour in slice_.contours:
            kind = _kind(contour, rings[contour.structure])
            regions.setdefault((contour.structure, slice_.view), []).append(
                _contour(contour, kind, study)
            )
    dataset.StructureSetROISequence = []
    dataset.ROIContourSequence = []
    dataset.RTROIObservationsSequence = []
    for number, ((structure, view), contours) in enumerate(sorted(regions.items()), 1):
        roi, outlined, observed = Dataset(), Dataset(), Dataset()
        roi.ROINumber = outlined.ReferencedROINumber = observed.ReferencedROINumber = number
        roi.ReferencedFrameOfReferenceUID = dataset.FrameOfReferenceUID
        named = "" if view is View.OTHER else f"_{view.value}"
        roi.ROIName = f"{_name(structure)}{named}".upper()
        roi.ROIGenerationAlgorithm = ""
        outlined.ROIDisplayColor = _COLOURS[structure]
        outlined.ContourSequence = contours
        observed.ObservationNumber = number
        observed.RTROIInterpretedType = "ORGAN"
        observed.ROIInterpreter = ""
        dataset.StructureSetROISequence.append(roi)
        dataset.ROIContourSequence.append(outlined)
        dataset.RTROIObservationsSequence.append(observed)


def _name(structure: Structure) -> str:
    return "biv_epi" if structure is Structure.EPI else structure.value


def _kind(contour: Contour, rings: int) -> str:
    if not contour.closed:
        return "OPEN_PLANAR"
    return "CLOSEDPLANAR_XOR" if rings > 1 else "CLOSED_PLANAR"


def _contour(contour: Contour, kind: str, study: ContourStudy) -> "Dataset":
    from pydicom.dataset import Dataset

    mm = study.units.millimetres
    sign = (1.0, 1.0, 1.0) if study.axes is Axes.LPS else (-1.0, -1.0, 1.0)
    item = Dataset()
    item.ContourGeometricType = kind
    item.NumberOfContourPoints = len(contour.points)
    item.ContourData = [
        f"{s * x * mm:.{_DECIMALS}f}"
        for point in contour.points
        for s, x in zip(sign, point, strict=True)
    ]
    return item
