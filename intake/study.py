"""The door: a contour study is admitted here, or refused with its reason, before anything heavy."""

from intake.agreement import check_agreement
from intake.flatness import check_flatness
from intake.intersections import check_intersections
from intake.limits import Limits, check_size
from intake.measured_outline import measured_outlines
from intake.multiplicity import check_multiplicity
from intake.nesting import check_nesting
from intake.outlines import check_outlines
from intake.placed import place
from intake.size import check_extent
from intake.support import check_support
from schemas.options import Options
from schemas.study import ContourStudy
from schemas.vocabulary import Structure

DEFAULT_LIMITS = Limits()

MAX_WARNINGS = 100
"""Warnings given in full; of more, only the number."""


def admit(
    study: ContourStudy,
    options: Options,
    limits: Limits = DEFAULT_LIMITS,
    *,
    pointer: str = "/study",
) -> list[str]:
    """Warnings about a study that can be reconstructed.

    Checked in this order, and the first fault is reported: counts, size, then slice by slice that
    points are on their plane and contours enclose an area once, then that structures lie in and
    beside one another, that slices agree, and that the requested surfaces are observed.
    What no check can see: axes named wrongly throughout. An LPS study sent as RAS is the heart
    turned by half a circle about the body's long axis, and as good a heart.

    Args:
        study: in its own units and axes.
        options: `surfaces` is held against what the study observes.
        limits: counts that a study may reach.
        pointer: where the study stands in the request, "" for a document of its own.

    Raises:
        InputError: with the JSON pointer of the offending part; see docs/problems.md.
    """
    check_size(study, limits, pointer)
    extent_mm, warnings = check_extent(study, pointer)
    frames = place(study, pointer)
    slices = [s for frame in frames for s in frame.slices]
    for slice_, outlines in zip(slices, measured_outlines(slices), strict=True):
        check_flatness(slice_, extent_mm)
        warnings += check_outlines(slice_, outlines, extent_mm)
        check_multiplicity(slice_)
    warnings += check_nesting(slices, extent_mm)
    for frame in frames:
        warnings += check_agreement(frame, extent_mm)
        warnings += check_intersections(frame, extent_mm)
    warnings += check_support(study, options, pointer)
    return shortened(warnings + _never_outlined(study))


def _never_outlined(study: ContourStudy) -> list[str]:
    slices = [s for frame in study.frames for s in frame.slices]
    outlined = {c.structure for s in slices for c in s.contours}
    absent = {structure for s in slices for structure in s.absent}
    return [
        f"{structure} is listed absent but outlined nowhere; it is not reconstructed."
        for structure in Structure
        if structure in absent - outlined
    ]


def shortened(warnings: list[str]) -> list[str]:
    """The warnings, or the first hundred and how many more there are."""
    more = len(warnings) - MAX_WARNINGS
    return warnings if more <= 0 else [*warnings[:MAX_WARNINGS], f"And {more} more warnings."]
