"""What the stack of one frame says of its slices' shifts, before any field."""

from schemas.options import Options
from worker.reconstruction.crossings import crossing_evidence
from worker.reconstruction.shift_evidence import ShiftEvidence
from worker.reconstruction.stack_smoothness import smoothness_evidence
from worker.reconstruction.unit_stack import UnitStack

_CONTOUR_NOISE_MM = 0.25
"""How well an observer's outline is known, at best: crossings do not fix a shift any better."""

_WIDEST_PRIOR = 0.1
"""Bound on the shift prior, unit lengths: a mouse's breath is not a man's."""

FURTHEST_SHIFT = 0.4
"""And on shifts."""


def prior_and_noise(options: Options, unit_mm: float) -> tuple[float, float]:
    """Standard deviations of a shift, at most, and of an outline, at least, in unit lengths."""
    prior = min(options.alignment.prior_mm / unit_mm, _WIDEST_PRIOR)
    return prior, min(_CONTOUR_NOISE_MM / unit_mm, prior)


def stack_evidence(stack: UnitStack, options: Options, unit_mm: float) -> ShiftEvidence:
    """What is known of the slices' shifts, and of how unsteady outlines are.

    stack: with the outlines of the surfaces that are fitted alone.
    """
    prior, noise = prior_and_noise(options, unit_mm)
    crossed = crossing_evidence(stack, prior, noise, turning=options.alignment.rotate)
    if not options.align_slices:
        return crossed.in_place(prior)
    if crossed.crossings.any():
        return crossed
    return smoothness_evidence(stack, prior, noise, unit_mm, turning=options.alignment.rotate)
