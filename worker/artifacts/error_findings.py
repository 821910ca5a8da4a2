"""What is suspicious about surfaces beside something else: a reference, other fits."""

from collections.abc import Sequence

from schemas.frame_report import FrameReport
from worker.artifacts.findings import Finding

_HELD_OUT_P95_MM, _SPREAD_P95_MM = 4.0, 2.0
_REFERENCE_MM, _OTHER_SHAPE_MM = 2.0, 5.0


def reference_findings(frames: Sequence[FrameReport]) -> list[Finding]:
    """Surfaces that are elsewhere than their reference."""
    return [
        Finding(
            surface.reference.hausdorff95_mm > _OTHER_SHAPE_MM,
            surface.reference.hausdorff95_mm,
            f"{frame.label} {structure}: the 95th percentile of its distance to the reference is "
            f"{surface.reference.hausdorff95_mm:.1f} mm. Colour it by distance in 3D to see where; "
            "check that both are of the same frame and in the same axes.",
        )
        for frame in frames
        for structure, surface in frame.surfaces.items()
        if surface.reference and surface.reference.hausdorff95_mm > _REFERENCE_MM
    ]


def held_out_findings(frames: Sequence[FrameReport]) -> list[Finding]:
    """Surfaces that were elsewhere when a slice was left out."""
    found = []
    for frame in frames:
        for structure, surface in frame.surfaces.items():
            error = surface.held_out_mm
            if error is None or error.p95 <= _HELD_OUT_P95_MM:
                continue
            missed = {
                s.id: s.held_out_mm[structure] for s in frame.slices if structure in s.held_out_mm
            }
            worst = max(missed, key=lambda name: missed[name].p95, default=None)
            where = f", most at slice {worst} ({missed[worst].p95:.1f} mm)" if worst else ""
            text = (
                f"{frame.label} {structure}: without a slice, the surface misses a twentieth of "
                f"that slice's contour by {error.p95:.1f} mm or more{where}. Between slices expect "
                "up to as much; add slices there."
            )
            found.append(Finding(False, error.p95, text))
    return found


def spread_findings(frames: Sequence[FrameReport]) -> list[Finding]:
    """Surfaces that other seeds put elsewhere."""
    return [
        Finding(
            False,
            surface.deviation_mm.p95,
            f"{frame.label} {structure}: fits with other seeds put a twentieth of the surface "
            f"elsewhere by {surface.deviation_mm.p95:.1f} mm or more (standard deviation). Colour "
            "it by deviation in 3D, and add a slice where it is largest.",
        )
        for frame in frames
        for structure, surface in frame.surfaces.items()
        if surface.deviation_mm and surface.deviation_mm.p95 > _SPREAD_P95_MM
    ]
