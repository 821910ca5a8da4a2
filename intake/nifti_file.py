"""A NIfTI label map as a file: small enough, and as long as its header says."""

from intake.inflate import Source, read_head, verify
from intake.label_map_faults import unreadable
from intake.limits import Limits
from intake.nifti_header import DAMAGED_REMEDY, NiftiHeader, parse_nifti_header
from intake.nifti_layout import HEADER_BYTES
from schemas.problem import InputError, ProblemType


def read_nifti_header(source: Source, limits: Limits, pointer: str) -> NiftiHeader:
    """Read a header, judge it, and hold the file against it by inflating it once, piecewise.

    `pointer` names the file part in what is raised. Sizes are judged before a voxel is inflated.

    Raises:
        InputError: as `parse_nifti_header`; `UNREADABLE_LABEL_MAP` also for a file of another size
            than its header says; `TOO_LARGE` (413).
    """
    header = parse_nifti_header(read_head(source, HEADER_BYTES[2], pointer), pointer)
    _check_size(header, limits, pointer)
    held = verify(source, limits.max_inflated_bytes, pointer)
    if held != header.inflated_bytes:
        raise unreadable(
            pointer,
            f"the header promises {header.inflated_bytes} bytes ({header}) and the file holds "
            f"{held}",
            DAMAGED_REMEDY,
        )
    return header


def _check_size(header: NiftiHeader, limits: Limits, pointer: str) -> None:
    for found, limit, what in (
        (header.frames, limits.max_frames, "frames"),
        (header.voxels, limits.max_voxels, "voxels"),
        (header.inflated_bytes, limits.max_inflated_bytes, "bytes"),
    ):
        if found > limit:
            raise InputError(
                ProblemType.TOO_LARGE,
                f"`{pointer}` holds {found} {what} by its header ({header}); at most "
                f"{limit} are accepted. Remedy: crop it to the heart, store the labels as uint8, "
                "or send fewer frames a job.",
                pointer=pointer,
                status=413,
            )
