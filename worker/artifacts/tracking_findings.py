"""What is suspicious about tracked meshes."""

from collections.abc import Mapping

from schemas.tracking_report import TrackedFrameReport, TrackedSurfaceReport
from schemas.vocabulary import Structure
from worker.artifacts.findings import Finding


def tracking_findings(tracking: Mapping[Structure, TrackedSurfaceReport]) -> list[Finding]:
    """Surfaces whose tracked mesh is not fit in some frames, with what is wrong in the worst."""
    found = []
    for structure, surface in tracking.items():
        unfit = {label: frame for label, frame in surface.frames.items() if not frame.fit}
        if unfit:
            worst = max(unfit, key=lambda label: _badness(unfit[label]))
            text = (
                f"{structure}: its tracked mesh is not fit in {len(unfit)} of "
                f"{len(surface.frames)} frames. {worst}: {' '.join(unfit[worst].reasons)}"
            )
            found.append(Finding(False, float(len(unfit)), text))
    return found


def _badness(frame: TrackedFrameReport) -> tuple[int, float]:
    faults = frame.turned_over + frame.folded + frame.self_intersections
    return faults, max(frame.to_surface_mm.mean, frame.from_surface_mm.mean)
