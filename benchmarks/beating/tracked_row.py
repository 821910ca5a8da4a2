"""A tracked surface's own measures over all frames."""

from benchmarks.beating.results import TrackedRow
from worker.tracking.tracked_surface import TrackedSurface


def tracked_row(tracked: TrackedSurface) -> TrackedRow:
    """Distances by frame, faults added up."""
    frames = tracked.frames
    return TrackedRow(
        vertices=tracked.vertices_mm.shape[1],
        to_own_mm=[frame.to_surface.mean_mm for frame in frames],
        from_own_mm=[frame.from_surface.mean_mm for frame in frames],
        turned_over=sum(frame.turned_over for frame in frames),
        against_surface=sum(frame.against_surface for frame in frames),
        folded=sum(frame.folded for frame in frames),
        self_intersections=sum(frame.self_intersections for frame in frames),
        least_angle_deg=min(frame.least_angle_deg for frame in frames),
        drift_mean_mm=tracked.drift_mean_mm,
        drift_max_mm=tracked.drift_max_mm,
    )
