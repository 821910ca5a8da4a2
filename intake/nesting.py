"""Do the structures of a slice lie in and beside one another as in a heart?"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from intake.even_odd import following
from intake.overlap import Overlap, overlaps
from intake.placed import PlacedSlice
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Structure

Array = NDArray[np.float64]

S = Structure

INSIDE = (
    (S.LV_ENDO, S.LV_EPI),
    (S.RV_ENDO, S.RV_EPI),
    (S.LV_ENDO, S.EPI),
    (S.RV_ENDO, S.EPI),
    (S.LV_EPI, S.EPI),
    (S.RV_EPI, S.EPI),
)
"""Each first structure lies within the second."""

APART = (
    (S.LV_ENDO, S.RV_ENDO),
    (S.LV_ENDO, S.RV_EPI),
    (S.LV_EPI, S.RV_ENDO),
    (S.LV_EPI, S.RV_EPI),
)
"""Ventricles share nothing: the septum belongs to the left one."""

TOLERATED_SHARE = 0.10
"""Of the smaller structure's area: what two readings of one border differ by."""

_SHARE_OF_OPEN = 0.50
"""The same when a contour is open: its closing chord is no border."""

_NOTED_SHARE = 0.02


def check_nesting(slices: Sequence[PlacedSlice], extent_mm: float) -> list[str]:
    """Warnings about small crossings of the structures on each slice.

    Refused is a crossing of more than a tenth of the smaller structure (half, where a contour is
    open) that also reaches more than 0.5 % of the study's extent deep: slivers between two borders
    that touch are no fault.

    Raises:
        InputError: `CROSSING_STRUCTURES` at the first contour of the structure that is misplaced.
    """
    meetings = [meeting for slice_ in slices for meeting in _meetings(slice_)]
    there = [(m.slice.rings(m.one), m.slice.rings(m.other)) for m in meetings]
    back = [(b, a) for m, (a, b) in zip(meetings, there, strict=True) if not m.is_nested]
    found, found_back = overlaps(there), iter(overlaps(back))
    warnings = []
    for meeting, ab in zip(meetings, found, strict=True):
        slice_, one, other = meeting.slice, meeting.one, meeting.other
        if meeting.is_nested:
            misplaced = Overlap(ab.area_mm2, ab.outside_mm2)
            warnings += _judge(slice_, one, other, misplaced, "outside", extent_mm)
            continue
        ba = next(found_back)
        if ab.area_mm2 < ba.area_mm2:
            warnings += _judge(slice_, one, other, ab, "within", extent_mm)
        else:
            warnings += _judge(slice_, other, one, ba, "within", extent_mm)
    return warnings


@dataclass(frozen=True)
class _Meeting:
    """Two structures of a slice: the first within the second, or apart from it."""

    slice: PlacedSlice
    one: Structure
    other: Structure
    is_nested: bool


def _meetings(slice_: PlacedSlice) -> Iterator[_Meeting]:
    here = set(slice_.structures)
    for inner, outer in INSIDE:
        if {inner, outer} <= here:
            yield _Meeting(slice_, inner, outer, is_nested=True)
    for a, b in APART:
        if {a, b} <= here and _boxes_meet(slice_, a, b):
            yield _Meeting(slice_, a, b, is_nested=False)


def _judge(
    slice_: PlacedSlice,
    one: Structure,
    other: Structure,
    bad: Overlap,
    where: str,
    extent_mm: float,
) -> list[str]:
    share = bad.share
    if share <= _NOTED_SHARE:
        return []
    said = f"Slice {slice_.id}: {100 * share:.0f} % of {one} lies {where} {other}"
    contours = slice_.of(one) + slice_.of(other)
    closed = all(c.closed for c in contours)
    allowed = TOLERATED_SHARE if closed else _SHARE_OF_OPEN
    # Area over outline: the mean depth of a crossing along the whole border.
    outline_mm = sum(_length(c.ring) for c in slice_.of(one))
    if share > allowed and bad.shared_mm2 / outline_mm > 0.005 * extent_mm:
        raise InputError(
            ProblemType.CROSSING_STRUCTURES,
            f"{said}; {100 * allowed:.0f} % is tolerated"
            f"{'' if closed else ' where an open contour is closed by a chord'}. "
            f"{_remedy(one, other, where)}",
            pointer=slice_.of(one)[0].pointer,
        )
    return [f"{said}; the surfaces will not cross, so they leave one of the contours there."]


def _remedy(one: Structure, other: Structure, where: str) -> str:
    if where == "outside":
        return (
            f"Remedy: check that {one} and {other} are not swapped and are of the same instant; "
            f"{other} is the filled outline, without the cavity as a hole."
        )
    return (
        f"Remedy: correct the contours so that {one} and {other} are side by side; "
        "the septum belongs to the left ventricle."
    )


def _length(ring: Array) -> float:
    return float(np.linalg.norm(following(ring) - ring, axis=1).sum())


def _boxes_meet(slice_: PlacedSlice, a: Structure, b: Structure) -> bool:
    one, other = np.concatenate(slice_.rings(a)), np.concatenate(slice_.rings(b))
    meet = (one.min(axis=0) <= other.max(axis=0)) & (other.min(axis=0) <= one.max(axis=0))
    return bool(meet.all())
