"""Clinical files made of known studies, by pydicom and ElementTree alone."""

import io
from collections.abc import Mapping, Sequence
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian, MRImageStorage

from intake.formats.image_geometry import ImageGeometry
from schemas.study import ContourStudy
from schemas.vocabulary import Structure

RT_STRUCTURE_SET = "1.2.840.10008.5.1.4.1.1.481.3"
ROI_NAMES = {
    Structure.LV_ENDO: "LV Endocardium",
    Structure.LV_EPI: "lv_epi",
    Structure.RV_ENDO: "RV_ENDO",
}
PATIENT = "Doe^Jane"

_HASH = "http://www.circlecvi.com/cvi42/Workspace/Hash/"
_LIST = "http://www.circlecvi.com/cvi42/Workspace/List/"
_POINT = "http://www.circlecvi.com/cvi42/Workspace/Point/"


def saved(dataset: Dataset, sop_class: str, syntax: str = ExplicitVRLittleEndian) -> bytes:
    """The bytes of a DICOM file; the patient is named in it."""
    dataset.SOPClassUID = sop_class
    dataset.SOPInstanceUID = dataset.get("SOPInstanceUID", "1.2.3.999")
    dataset.PatientName = PATIENT
    dataset.PatientID = "MRN-4711"
    dataset.PatientBirthDate = "19611224"
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = sop_class
    meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID
    meta.TransferSyntaxUID = syntax
    stream = io.BytesIO()
    FileDataset(stream, dataset, file_meta=meta, preamble=b"\0" * 128).save_as(
        stream, enforce_file_format=True
    )
    return stream.getvalue()


def contour(
    points: Any, kind: str = "CLOSED_PLANAR", image: str = "", decimals: int = 6
) -> Dataset:
    item = Dataset()
    if image:
        reference = Dataset()
        reference.ReferencedSOPClassUID = MRImageStorage
        reference.ReferencedSOPInstanceUID = image
        item.ContourImageSequence = [reference]
    item.ContourGeometricType = kind
    item.NumberOfContourPoints = len(points)
    item.ContourData = [f"{x:.{decimals}f}" for point in points for x in point]
    return item


def structure_set(
    rois: Sequence[tuple[str, Sequence[Dataset]]], label: str = "contours"
) -> Dataset:
    dataset = Dataset()
    dataset.StructureSetLabel = label
    dataset.StructureSetROISequence = []
    dataset.ROIContourSequence = []
    for number, (name, contours) in enumerate(rois, start=1):
        roi, of_roi = Dataset(), Dataset()
        roi.ROINumber = number
        roi.ROIName = name
        of_roi.ReferencedROINumber = number
        of_roi.ContourSequence = list(contours)
        dataset.StructureSetROISequence.append(roi)
        dataset.ROIContourSequence.append(of_roi)
    return dataset


def rtstruct(
    rois: Sequence[tuple[str, Sequence[Dataset]]], syntax: str = ExplicitVRLittleEndian
) -> bytes:
    return saved(structure_set(rois), RT_STRUCTURE_SET, syntax)


def rois_of(
    study: ContourStudy, suffix: Mapping[str, str] | None = None
) -> list[tuple[str, list[Dataset]]]:
    """A region for each structure and each frame whose label has a suffix."""
    return [
        (
            ROI_NAMES[structure] + ("" if suffix is None else suffix[frame.label]),
            [
                contour(c.points, "CLOSED_PLANAR" if c.closed else "OPEN_PLANAR")
                for s in frame.slices
                for c in s.contours
                if c.structure is structure
            ],
        )
        for frame in study.frames
        for structure in ROI_NAMES
    ]


def image(uid: str, at: ImageGeometry, description: str = "cine") -> bytes:
    """An MR image of the smallest size, with its pixels."""
    dataset = Dataset()
    dataset.SOPInstanceUID = uid
    dataset.SeriesDescription = description
    dataset.ImagePositionPatient = [f"{x:.9g}" for x in at.position_mm]
    dataset.ImageOrientationPatient = [f"{x:.9g}" for x in (*at.row, *at.column)]
    dataset.PixelSpacing = list(at.spacing_mm)
    if at.temporal_position is not None:
        dataset.TemporalPositionIdentifier = at.temporal_position
    if at.trigger_ms is not None:
        dataset.TriggerTime = at.trigger_ms
    dataset.Rows, dataset.Columns = 4, 4
    dataset.BitsAllocated = dataset.BitsStored = 16
    dataset.HighBit, dataset.PixelRepresentation = 15, 0
    dataset.SamplesPerPixel, dataset.PhotometricInterpretation = 1, "MONOCHROME2"
    dataset.PixelData = np.zeros((4, 4), np.uint16).tobytes()
    return saved(dataset, MRImageStorage)


def item(parent: ET.Element, key: str, text: str = "") -> ET.Element:
    element = ET.SubElement(parent, f"{{{_HASH}}}item", {f"{{{_HASH}}}key": key})
    element.text = text
    return element


def workspace(contours: Mapping[str, Mapping[str, Any]], subpixels: int | None = 4) -> bytes:
    """A cvi42 workspace: pixel coordinates (n, 2) by image and name."""
    root = ET.Element("Workspace")
    study = item(root, "StudyMapStates")
    entry = ET.SubElement(study, f"{{{_LIST}}}item")
    item(entry, "StudyUid", "1.2.3")
    item(entry, "PatientName", PATIENT)
    images = item(entry, "ImageStates")
    for uid, by_name in contours.items():
        held = item(item(images, uid), "Contours")
        for name, pixels in by_name.items():
            of_contour = item(held, name)
            points = item(of_contour, "Points")
            for x, y in np.asarray(pixels) * (subpixels or 1):
                point = ET.SubElement(points, f"{{{_LIST}}}item")
                ET.SubElement(point, f"{{{_POINT}}}x").text = repr(float(x))
                ET.SubElement(point, f"{{{_POINT}}}y").text = repr(float(y))
            if subpixels is not None:
                item(of_contour, "SubpixelResolution", str(subpixels))
    return ET.tostring(root, encoding="utf-8", xml_declaration=True)
