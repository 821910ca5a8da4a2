"""What is suspicious about slices: contours that the surface misses, and where slices lie."""

import math
from collections.abc import Iterator, Sequence

from schemas.frame_report import FrameReport, SliceReport
from worker.artifacts.findings import Finding

_RESIDUAL_P95_MM, _RESIDUAL_MAX_MM = 1.0, 2.0
"""Less than a pixel of a usual cine image, and more than the surface strays from a steady hand."""

_NOISY_P95, _NOISY_MAX = 2.0, 4.0
"""The same in standard deviations of the contours' own noise, which no surface can follow."""

_MISSED_MM = 5.0
"""A surface this far from a contour shows something else than the contour does."""

_DICE, _POOR_DICE = 0.9, 0.7
_SHIFT_MM, _SHIFT_DEVIATION_MM = 5.0, 2.0


def residual_findings(frames: Sequence[FrameReport]) -> list[Finding]:
    """Contours that the surface misses by more than their noise lets expect."""
    found = []
    for frame, one in _slices(frames):
        noise_mm = frame.contour_noise_mm or 0.0
        p95_mm = max(_RESIDUAL_P95_MM, _NOISY_P95 * noise_mm)
        max_mm = max(_RESIDUAL_MAX_MM, _NOISY_MAX * noise_mm)
        for structure, residual in one.contour_residual_mm.items():
            if residual.max > max_mm or residual.p95 > p95_mm:
                text = (
                    f"{frame.label} {structure}, slice {one.id}: the contour is up to "
                    f"{residual.max:.1f} mm from the surface, a twentieth of it {residual.p95:.1f} "
                    "mm or more. See the slice below; correct the contour, or leave the slice out."
                )
                grave = residual.p95 > _MISSED_MM
                found.append(Finding(grave, max(residual.max / 2.0, residual.p95), text))
    return found


def overlap_findings(frames: Sequence[FrameReport]) -> list[Finding]:
    """Slices on which contour and surface enclose different areas."""
    found = []
    for frame, one in _slices(frames):
        for structure, dice in one.dice.items():
            if dice is not None and dice < _DICE:
                text = (
                    f"{frame.label} {structure}, slice {one.id}: contour and surface overlap with "
                    f"a Dice of {dice:.2f}, of 1 at best. See the slice below; correct the "
                    "contour, or leave the slice out."
                )
                found.append(Finding(dice < _POOR_DICE, 1.0 - dice, text))
    return found


def shift_findings(frames: Sequence[FrameReport]) -> list[Finding]:
    """Slices that were found far from where they were said to be."""
    found = []
    for frame, one in _slices(frames):
        shift_mm = math.hypot(*one.shift_mm)
        if shift_mm > _SHIFT_MM:
            basis = (
                "no long-axis contour confirms it"
                if one.shift_deviation_mm is None
                else f"known to ± {one.shift_deviation_mm:.1f} mm"
            )
            text = (
                f"{frame.label}, slice {one.id}: found {shift_mm:.1f} mm from where it was said to "
                f"be ({basis}). Check its position and its breath-hold, and its place below."
            )
            found.append(Finding(False, shift_mm, text))
    return found


def uncertain_shift_findings(frames: Sequence[FrameReport]) -> list[Finding]:
    """Slices whose shift could as well be another."""
    return [
        Finding(
            False,
            one.shift_deviation_mm,
            f"{frame.label}, slice {one.id}: its shift is known to ± {one.shift_deviation_mm:.1f} "
            f"mm only, from {one.crossings} crossings with long-axis contours. Add a long-axis "
            "slice, or take the surface near it as uncertain by as much.",
        )
        for frame, one in _slices(frames)
        if one.shift_deviation_mm is not None and one.shift_deviation_mm > _SHIFT_DEVIATION_MM
    ]


def _slices(frames: Sequence[FrameReport]) -> Iterator[tuple[FrameReport, SliceReport]]:
    return ((frame, one) for frame in frames for one in frame.slices)
