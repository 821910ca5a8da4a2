"""Voxel index to patient space: which transform a NIfTI header means, and whether it is sound.

Source: nifti1.h, methods 1 to 3. World axes are RAS; an affine's last column is the centre of the
first voxel.
"""

import math
from collections.abc import Sequence
from itertools import product

from intake.nifti_header import NiftiHeader, Row
from schemas.problem import InputError, ProblemType

Rows = tuple[Row, Row, Row]
Triple = tuple[float, float, float]

_SHEAR = 0.01
"""Cosine between two voxel axes above which they are not at right angles (0.6 degrees)."""
_QUATERNION_EXCESS = 1e-3
"""How far b^2 + c^2 + d^2 may pass 1 before it is more than rounding."""
_HALF_TURN = 3 * 2.0**-23
"""How near to 1 it is 1, in single precision: three steps of a float32 at 1, exactly as in nibabel,
since between two thresholds one reader sees a half turn and the other 0.07 degrees less.
"""


def sform_rows(header: NiftiHeader, pointer: str) -> Rows | None:
    """Method 3: the first three rows of the affine, in the file's own unit, checked.

    None when the header has no sform. Raises InputError: `INVALID_AFFINE` when it is not finite,
    singular, or sheared.
    """
    if header.sform is None:
        return None
    _check("sform", header.sform, pointer)
    return header.sform


def qform_rows(header: NiftiHeader, pointer: str) -> Rows | None:
    """Method 2: a rotation by a unit quaternion, sizes from pixdim, handedness from qfac; checked.

    As `sform_rows`, also for a quaternion that is none.
    """
    if header.quaternion is None:
        return None
    rows = _from_quaternion(header.quaternion, header.pixdim, pointer)
    _check("qform", rows, pointer)
    return rows


def farthest_apart(rows: Rows, others: Rows, shape: Sequence[int]) -> float:
    """How far apart two affines put a corner voxel of the grid, at most, in the affines' unit."""
    corners = product(*((0, n - 1) for n in shape))
    return max(
        math.hypot(
            *(
                sum((a - b) * n for a, b, n in zip(row, other, (*corner, 1), strict=True))
                for row, other in zip(rows, others, strict=True)
            )
        )
        for corner in corners
    )


def column_lengths(rows: Rows) -> Triple:
    """Voxel size along each axis, in the unit of the affine."""
    x, y, z = (math.hypot(*(row[axis] for row in rows)) for axis in range(3))
    return x, y, z


def scaled_columns(rows: Rows, factors: Sequence[float]) -> Rows:
    """The affine with each voxel axis lengthened by a factor; the origin stays."""
    i, j, k = factors
    a, b, c = ((row[0] * i, row[1] * j, row[2] * k, row[3]) for row in rows)
    return a, b, c


def _check(name: str, rows: Rows, pointer: str) -> None:
    if not all(math.isfinite(value) for row in rows for value in row):
        raise _invalid(f"the {name} of `{pointer}` holds NaN or infinity", pointer)
    lengths = column_lengths(rows)
    if min(lengths) == 0.0:
        raise _invalid(
            f"the {name} of `{pointer}` is singular (a voxel axis of no length)", pointer
        )
    axes = [[row[axis] / lengths[axis] for row in rows] for axis in range(3)]
    worst = max(
        abs(sum(a * b for a, b in zip(axes[i], axes[j], strict=True)))
        for i, j in ((0, 1), (0, 2), (1, 2))
    )
    if worst > 1.0 - 1e-6:
        raise _invalid(f"the {name} of `{pointer}` is singular (two voxel axes coincide)", pointer)
    if worst > _SHEAR:
        off = 90.0 - math.degrees(math.acos(worst))
        raise _invalid(
            f"the {name} of `{pointer}` is sheared: two voxel axes are {off:.1f} degrees off a "
            "right angle",
            pointer,
        )


def _from_quaternion(q: Sequence[float], pixdim: Triple, pointer: str) -> Rows:
    b, c, d, x, y, z, qfac = q
    squares = b * b + c * c + d * d
    if not squares <= 1.0 + _QUATERNION_EXCESS:
        raise _invalid(f"the qform of `{pointer}` has no unit quaternion", pointer)
    a = math.sqrt(max(0.0, 1.0 - squares))
    if squares > 1.0 - _HALF_TURN:
        b, c, d, a = (value / math.sqrt(squares) for value in (b, c, d, 0.0))
    rotation: Rows = (
        (a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c), x),
        (2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b), y),
        (2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c, z),
    )
    return scaled_columns(rotation, (pixdim[0], pixdim[1], pixdim[2] * qfac))


def _invalid(what: str, pointer: str) -> InputError:
    return InputError(
        ProblemType.INVALID_AFFINE,
        f"{what}. Remedy: resample the map onto a grid with axes at right angles, nearest "
        "neighbour, or restore the affine of the image that was segmented.",
        pointer=pointer,
    )
