"""Everything that the headers of a label request decide, before it is accepted.

Door and worker call the same function, so they cannot differ.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from intake.inflate import Source
from intake.limits import Limits
from intake.nifti_file import read_nifti_header
from intake.nifti_header import NiftiHeader
from intake.voxel_size import VoxelGeometry, check_voxel_size
from schemas.labels import LabelRequest, TissueLabels
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import View


@dataclass(frozen=True)
class CheckedMap:
    """One label map whose header holds: what it says, and where its voxels lie."""

    header: NiftiHeader
    geometry: VoxelGeometry


def check_label_maps(
    files: Mapping[View, Source], request: LabelRequest, limits: Limits
) -> dict[View, CheckedMap]:
    """Judge the headers of all views, alone and against one another.

    Raises:
        InputError: as `read_nifti_header` and `check_voxel_size`, with the view's name as pointer;
            `MISMATCHED_VIEWS` when views differ in frames; `INVALID_AFFINE` when one of several
            views has no orientation; `INVALID_REQUEST` for no file, a number of frame labels that
            is not the maps', or a wall declared without its cavity.
    """
    _check_scheme(request)
    if not files:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "no label map was sent. Remedy: send one file part a view: sax, lax_2ch, lax_3ch or "
            "lax_4ch.",
            pointer=View.SAX,
        )
    checked: dict[View, CheckedMap] = {}
    for view, source in files.items():
        header = read_nifti_header(source, limits, view)
        checked[view] = CheckedMap(header, check_voxel_size(header, request.spacing, view))
    _check_orientation(checked)
    _check_frames(checked, request)
    return checked


def _check_scheme(request: LabelRequest) -> None:
    scheme = request.label_scheme
    if not isinstance(scheme, TissueLabels):
        return
    for wall, cavity in (("lv_wall", "lv_cavity"), ("rv_wall", "rv_cavity")):
        if getattr(scheme, wall) and not getattr(scheme, cavity):
            raise InputError(
                ProblemType.INVALID_REQUEST,
                f"the label scheme has {wall} and no {cavity}; the outer surface encloses both. "
                f"Remedy: label the cavity and list its value under `{cavity}`.",
                pointer=f"/label_scheme/{cavity}",
            )


def _check_orientation(checked: Mapping[View, CheckedMap]) -> None:
    """Without orientation a single short-axis stack still has a shape; views have no relation."""
    for view, map_ in checked.items():
        if not map_.geometry.directions_known and (len(checked) > 1 or view is not View.SAX):
            raise InputError(
                ProblemType.INVALID_AFFINE,
                f"`{view}` has no orientation (qform and sform codes are 0), so it cannot be "
                "placed among the views. Remedy: restore the affine of the image that was "
                "segmented, or send the short-axis stack alone.",
                pointer=view,
            )


def _check_frames(checked: Mapping[View, CheckedMap], request: LabelRequest) -> None:
    counts = {view: map_.header.frames for view, map_ in checked.items()}
    (first, frames), *others = counts.items()
    for view, count in others:
        if count != frames:
            raise InputError(
                ProblemType.MISMATCHED_VIEWS,
                f"`{view}` has {count} frames and `{first}` has {frames}. Remedy: send the same "
                "frames of every view, in the same order.",
                pointer=view,
            )
    labels = request.frame_labels
    if labels is not None and len(labels) != frames:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"{len(labels)} frame labels for {frames} frames. Remedy: give one label a frame, or "
            "leave `frame_labels` out.",
            pointer="/frame_labels",
        )
