"""Where a voxel lies and how large it is, when a header says so twice and disagrees.

ACDC's files, for one, carry a unit-scale sform beside the true pixdim: the LV then measures 8 mL
instead of 223 mL.
"""

import math
from dataclasses import dataclass

from intake.nifti_affine import (
    Rows,
    Triple,
    column_lengths,
    farthest_apart,
    qform_rows,
    scaled_columns,
    sform_rows,
)
from intake.nifti_header import NiftiHeader, Row
from schemas.labels import Spacing
from schemas.problem import InputError, ProblemType

_TOLERANCE = 0.01
_UNIT = 1e-6
_APART_MM = 1.0


@dataclass(frozen=True)
class VoxelGeometry:
    """Voxel index to patient space, settled.

    affine_mm: 4 x 4, index (of the voxel's centre) to RAS, mm.
    directions_known: False when the header has no orientation and the voxel axes stand for RAS.
    warnings: what had to be decided, for the report.
    """

    affine_mm: tuple[Row, Row, Row, Row]
    directions_known: bool
    warnings: tuple[str, ...]

    @property
    def spacing_mm(self) -> Triple:
        return column_lengths(self.affine_mm[:3])


def check_voxel_size(header: NiftiHeader, spacing: Spacing, pointer: str) -> VoxelGeometry:
    """Settle the affine of a label map, by `spacing` where affine and pixdim disagree.

    The sform comes before the qform, as in nibabel. Axes of a single voxel are not compared. With
    `Spacing.AUTO` one disagreement is settled unasked, and reported: an sform of scale exactly 1
    has lost its scale. The qform then stands for it, or pixdim along the sform's directions.

    Raises:
        InputError: `AMBIGUOUS_VOXEL_SIZE` for any other disagreement of more than 1 %, or a pixdim
            that is needed and is not a positive number; `INVALID_AFFINE` for an affine that is not
            finite, singular or sheared.
    """
    if spacing is not Spacing.AFFINE or header.sform is None:
        _check_pixdim(header, pointer)
    sform = sform_rows(header, pointer)
    if sform is None:
        qform = qform_rows(header, pointer)
        if qform is None:
            return _without_orientation(header, spacing, pointer)
        return _geometry(qform, header)
    sizes = column_lengths(sform)
    if spacing is Spacing.AFFINE or _agree(header, sizes):
        return _geometry(sform, header, warnings=_other_qform(header, sform, pointer))
    scaled = scaled_columns(sform, _factors(header, sizes))
    if spacing is Spacing.PIXDIM:
        return _geometry(scaled, header)
    if any(abs(size - 1.0) > _UNIT for size in sizes):
        raise _ambiguous(header, sizes, pointer)
    qform = qform_rows(header, pointer)
    used = "the qform was used instead" if qform else "pixdim was used along its directions"
    warning = (
        f"{pointer}: the sform's voxel size is {_mm(sizes, header)} and pixdim's is "
        f"{_mm(header.pixdim, header)}; the sform has lost its scale, and {used} (send "
        "`spacing` to choose)."
    )
    return _geometry(qform or scaled, header, warnings=(warning,))


def _other_qform(header: NiftiHeader, sform: Rows, pointer: str) -> tuple[str, ...]:
    """A warning when the header also has a qform and it says otherwise."""
    try:
        qform = qform_rows(header, pointer)
    except InputError:
        return (f"{pointer}: the qform is unsound; the sform was used.",)
    if qform is None:
        return ()
    apart_mm = farthest_apart(sform, qform, header.shape) * header.mm_per_unit
    if apart_mm <= _APART_MM:
        return ()
    return (
        f"{pointer}: sform and qform put voxels up to {apart_mm:.1f} mm apart; the sform was used.",
    )


def _factors(header: NiftiHeader, sizes: Triple) -> list[float]:
    """What lengthens each voxel axis to its pixdim; a single voxel without one keeps its size."""
    return [
        size / own if n > 1 or _is_length(size) else 1.0
        for size, own, n in zip(header.pixdim, sizes, header.shape, strict=True)
    ]


def _without_orientation(header: NiftiHeader, spacing: Spacing, pointer: str) -> VoxelGeometry:
    """Method 1: sizes from pixdim, directions unknown."""
    if spacing is Spacing.AFFINE:
        raise InputError(
            ProblemType.INVALID_AFFINE,
            f"`spacing` is `affine` and `{pointer}` has none (qform and sform codes are 0). "
            "Remedy: restore the affine of the image, or send `spacing` as `pixdim`.",
            pointer=pointer,
        )
    _check_pixdim(header, pointer)
    i, j, k = (size if _is_length(size) else 1.0 for size in header.pixdim)
    return _geometry(
        ((i, 0.0, 0.0, 0.0), (0.0, j, 0.0, 0.0), (0.0, 0.0, k, 0.0)),
        header,
        directions_known=False,
        warnings=(
            f"{pointer}: the header has no orientation (qform and sform codes are 0); its voxel "
            "axes were taken for right, anterior and superior, and left and right may be swapped.",
        ),
    )


def _geometry(
    rows: Rows,
    header: NiftiHeader,
    *,
    directions_known: bool = True,
    warnings: tuple[str, ...] = (),
) -> VoxelGeometry:
    mm = header.mm_per_unit
    a, b, c = ((i * mm, j * mm, k * mm, t * mm) for i, j, k, t in rows)
    return VoxelGeometry((a, b, c, (0.0, 0.0, 0.0, 1.0)), directions_known, warnings)


def _is_length(size: float) -> bool:
    return math.isfinite(size) and size > 0.0


def _agree(header: NiftiHeader, sizes: Triple) -> bool:
    return all(
        abs(listed - own) <= _TOLERANCE * max(listed, own)
        for listed, own, n in zip(header.pixdim, sizes, header.shape, strict=True)
        if n > 1
    )


def _check_pixdim(header: NiftiHeader, pointer: str) -> None:
    if all(_is_length(size) for size, n in zip(header.pixdim, header.shape, strict=True) if n > 1):
        return
    raise InputError(
        ProblemType.AMBIGUOUS_VOXEL_SIZE,
        f"pixdim of `{pointer}` is {_times(header.pixdim)}, and a voxel size is positive. Remedy: "
        'write the true voxel size into pixdim, or send `spacing: "affine"` to use the affine\'s.',
        pointer=pointer,
    )


def _ambiguous(header: NiftiHeader, sizes: Triple, pointer: str) -> InputError:
    return InputError(
        ProblemType.AMBIGUOUS_VOXEL_SIZE,
        f"the voxel size of `{pointer}` is {_mm(sizes, header)} by the affine and "
        f'{_mm(header.pixdim, header)} by pixdim. Remedy: send `spacing: "affine"` or '
        '`spacing: "pixdim"`, whichever is true.',
        pointer=pointer,
    )


def _mm(sizes: Triple, header: NiftiHeader) -> str:
    a, b, c = sizes
    return f"{_times((a * header.mm_per_unit, b * header.mm_per_unit, c * header.mm_per_unit))} mm"


def _times(sizes: Triple) -> str:
    return " x ".join(f"{size:.4g}" for size in sizes)
