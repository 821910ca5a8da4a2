"""The files that come with contours and say where their images lie: DICOM images and tables."""

from collections.abc import Mapping

from intake.formats.clinical_faults import unreadable
from intake.formats.dicom_file import is_dicom
from intake.formats.geometry_table import is_table, read_geometry_table
from intake.formats.image_geometry import ImageGeometry, image_of
from intake.limits import Limits


def read_companions(
    files: Mapping[str, bytes], limits: Limits
) -> tuple[dict[str, ImageGeometry], list[str]]:
    """Geometry by SOP instance UID from every file of `files`, and what of them says nothing.

    Raises:
        InputError: at a file that is neither a DICOM file nor a geometry table.
    """
    images: dict[str, ImageGeometry] = {}
    without = 0
    for name, data in files.items():
        if is_dicom(data):
            uid, geometry = image_of(data, name, limits.max_inflated_bytes)
            if geometry is None:
                without += 1
            else:
                images[uid] = geometry
        elif is_table(data):
            images |= read_geometry_table(data, name, limits)
        else:
            raise unreadable(
                name,
                "is neither a DICOM file nor a table of image geometry",
                "leave it out, or see docs/clinical-files.md for what is read",
            )
    if not without:
        return images, []
    return images, [f"{without} DICOM files have no plane of an image and were not used."]
