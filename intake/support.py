"""Which surfaces a study holds enough contours for."""

import numpy as np

from intake.coincidence import coincident, count_distinct
from intake.planes import slice_plane
from schemas.options import Options
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy, Frame
from schemas.vocabulary import Structure

MIN_PLANES = 2
"""Distinct planes that a surface must be outlined on."""


def frame_surfaces(frame: Frame, options: Options) -> list[Structure]:
    """The surfaces to reconstruct in `frame`: those it supports, and of these those requested.

    A frame supports a surface that is outlined on at least two distinct planes. Frames may differ:
    clinical readers often draw the epicardium at end-diastole alone.
    """
    counts = planes_of(frame)
    wanted = set(options.surfaces or Structure)
    return [s for s in Structure if s in wanted and counts.get(s, 0) >= MIN_PLANES]


def planes_of(frame: Frame) -> dict[Structure, int]:
    """On how many distinct planes each observed structure is outlined."""
    outlined = [s for s in frame.slices if s.contours]
    if not outlined:
        return {}
    points = np.array([p for s in outlined for c in s.contours for p in c.points])
    centre, extent = points.mean(axis=0), float(np.linalg.norm(np.ptp(points, axis=0)))
    # All comparisons are relative to the extent, so the study's own unit will do.
    same = coincident([slice_plane(s, 1.0) for s in outlined], centre, extent)
    counts = {}
    for structure in Structure:
        at = [
            i for i, s in enumerate(outlined) if any(c.structure is structure for c in s.contours)
        ]
        if at:
            counts[structure] = count_distinct(same[np.ix_(at, at)])
    return counts


def check_support(study: ContourStudy, options: Options, pointer: str) -> list[str]:
    """Warnings about frames and surfaces that are left out or thinly observed.

    Raises:
        InputError: `TOO_FEW_SLICES` for a frame that supports no surface at all;
            `UNSUPPORTED_SURFACE` for a requested surface that no frame supports.
    """
    counts = [planes_of(frame) for frame in study.frames]
    for i, (frame, planes) in enumerate(zip(study.frames, counts, strict=True)):
        if max(planes.values(), default=0) < MIN_PLANES:
            _refuse_frame(frame, planes, f"{pointer}/frames/{i}/slices")
    supported = [s for s in Structure if any(c.get(s, 0) >= MIN_PLANES for c in counts)]
    for k, surface in enumerate(options.surfaces or ()):
        if surface not in supported:
            raise InputError(
                ProblemType.UNSUPPORTED_SURFACE,
                f"No frame has {surface} contours on {MIN_PLANES} distinct planes or more. "
                f"Remedy: request only what the study supports ({', '.join(supported)}), "
                "or send more slices.",
                pointer=f"/options/surfaces/{k}",
            )
    wanted = [s for s in supported if options.surfaces is None or s in options.surfaces]
    return [
        warning
        for frame, planes in zip(study.frames, counts, strict=True)
        for warning in _warnings(frame, planes, wanted)
    ]


def _refuse_frame(frame: Frame, planes: dict[Structure, int], pointer: str) -> None:
    found = ", ".join(f"{s} on {n}" for s, n in planes.items()) or "no contours"
    raise InputError(
        ProblemType.TOO_FEW_SLICES,
        f"Frame {frame.label}: no structure is outlined on {MIN_PLANES} distinct planes or more "
        f"({found}). Remedy: send contours on more slices, or check the slices' `origin`s if they "
        "were meant to be apart.",
        pointer=pointer,
    )


def _warnings(frame: Frame, planes: dict[Structure, int], wanted: list[Structure]) -> list[str]:
    warnings = []
    missing = [s for s in wanted if planes.get(s, 0) < MIN_PLANES]
    if missing:
        warnings.append(
            f"Frame {frame.label}: {', '.join(missing)} will not be reconstructed, having contours "
            f"on fewer than {MIN_PLANES} distinct planes."
        )
    thin = [s for s in wanted if planes.get(s, 0) == MIN_PLANES]
    if thin:
        warnings.append(
            f"Frame {frame.label}: {', '.join(thin)} has contours on {MIN_PLANES} planes only; "
            "its shape away from them is a guess."
        )
    return warnings
