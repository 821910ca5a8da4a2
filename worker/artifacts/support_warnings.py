"""Plain words where a surface's end was not observed."""

from collections.abc import Mapping

from schemas.surface_report import EndReport, SurfaceReport
from schemas.vocabulary import Structure

_NOTABLE = 0.5
"""Distance of an end from all contours, in slice gaps, under which nothing is said of it: between
two slices the surface is as far from them."""

_NOTABLE_MM = 4.0
"""The same in mm, where one short-axis slice alone shows the surface."""


def support_warnings(label: str, surfaces: Mapping[Structure, SurfaceReport]) -> list[str]:
    """One sentence for each surface of a frame whose apex or base no contour follows."""
    return [
        f"{label} {structure}: {_sentence(ends)}"
        for structure, surface in surfaces.items()
        if (ends := _unobserved(surface))
    ]


def _unobserved(surface: SurfaceReport) -> dict[str, EndReport]:
    gap_mm = surface.slice_gap_mm
    notable_mm = _NOTABLE_MM if gap_mm is None else _NOTABLE * gap_mm
    return {
        name: end
        for name, end in (("apex", surface.apex), ("base", surface.base))
        if end and not end.on_long_axis and end.support_max_mm >= notable_mm
    }


def _sentence(ends: Mapping[str, EndReport]) -> str:
    far = " and ".join(f"{end.support_max_mm:.1f}" for end in ends.values())
    many = len(ends) > 1
    return (
        f"its {' and '.join(ends)} {'lie' if many else 'lies'} up to {far} mm from the nearest "
        f"contour; no long-axis slice shows {'them' if many else 'it'}, so its shape there is "
        "extrapolated."
    )
