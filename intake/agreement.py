"""Do the slices of a frame tell one story?"""

import numpy as np
from numpy.typing import NDArray

from intake.coincidence import coincident
from intake.overlap import overlap
from intake.placed import PlacedFrame, PlacedSlice
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Structure

Array = NDArray[np.float64]

_SAME_SHAPE = 0.75
"""Shared over joint area of two outlines of one structure that a repeated slice may show."""


def check_agreement(frame: PlacedFrame, extent_mm: float) -> list[str]:
    """Warnings about planes given twice.

    Raises:
        InputError: `CONTRADICTING_SLICES` when two slices on one plane show a structure in
            different places, or one shows it and the other lists it absent.
    """
    clouds = [c.points_mm for s in frame.slices for c in s.contours]
    if not clouds:
        return []
    centre: Array = np.concatenate(clouds).mean(axis=0)
    same = coincident([s.plane for s in frame.slices], centre, extent_mm)
    warnings = []
    for j, later in enumerate(frame.slices):
        # Held against the plane's first slice alone: a hundred copies are no ten thousand pairs.
        first = int(np.argmax(same[:, j]))
        if first < j:
            warnings += _compare(frame, frame.slices[first], later)
    return warnings


def _compare(frame: PlacedFrame, a: PlacedSlice, b: PlacedSlice) -> list[str]:
    denied = [s for s in a.structures if s in b.absent] + [s for s in b.structures if s in a.absent]
    if denied:
        _refuse(frame, a, b, f"one outlines {denied[0]} and the other lists it absent")
    warnings = []
    for structure in a.structures:
        if structure in b.structures:
            alike = _likeness(a, b, structure)
            if alike < _SAME_SHAPE:
                share = f"share only {100 * alike:.0f} % of their joint area"
                _refuse(frame, a, b, f"their {structure} outlines {share}")
            warnings.append(
                f"Frame {frame.label}: slices {a.id} and {b.id} outline {structure} on the same "
                "plane; both are used."
            )
    return warnings


def _likeness(a: PlacedSlice, b: PlacedSlice, structure: Structure) -> float:
    """Shared over joint area of a structure on two slices of one plane."""
    in_a = a.rings(structure)
    in_b = [a.plane.to_plane(c.points_mm) for c in b.of(structure)]
    ab, ba = overlap(in_a, in_b), overlap(in_b, in_a)
    return ab.shared_mm2 / (ab.outside_mm2 + ba.area_mm2)


def _refuse(frame: PlacedFrame, a: PlacedSlice, b: PlacedSlice, what: str) -> None:
    raise InputError(
        ProblemType.CONTRADICTING_SLICES,
        f"Frame {frame.label}: slices {a.id} and {b.id} lie on the same plane, but {what}. "
        "Remedy: keep one of them, or correct their planes; instants go into frames of their own.",
        pointer=b.pointer,
    )
