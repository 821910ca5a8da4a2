"""Tracked surfaces as the report has them."""

from collections.abc import Mapping

from schemas.measures import DistanceSummary
from schemas.tracking_report import TrackedFrameReport, TrackedSurfaceReport
from schemas.vocabulary import Structure
from worker.artifacts.tracking_gate import tracking_faults
from worker.evaluation.distance import DirectedDistance
from worker.tracking.tracked_surface import TrackedFrame, TrackedSurface


def tracking_report(
    tracked: Mapping[Structure, TrackedSurface],
) -> dict[Structure, TrackedSurfaceReport]:
    """Measures of every tracked surface, frame by frame."""
    return {structure: _surface(one) for structure, one in tracked.items()}


def _surface(tracked: TrackedSurface) -> TrackedSurfaceReport:
    return TrackedSurfaceReport(
        rest_frame=tracked.frames[tracked.rest].label,
        vertices=tracked.vertices_mm.shape[1],
        triangles=len(tracked.faces),
        drift_mean_mm=tracked.drift_mean_mm,
        drift_max_mm=tracked.drift_max_mm,
        not_observed=tracked.not_observed,
        frames={frame.label: _frame(frame) for frame in tracked.frames},
    )


def _frame(frame: TrackedFrame) -> TrackedFrameReport:
    reasons = tracking_faults(frame)
    return TrackedFrameReport(
        fit=not reasons,
        reasons=reasons,
        to_surface_mm=_summary(frame.to_surface),
        from_surface_mm=_summary(frame.from_surface),
        turned_over=frame.turned_over,
        against_surface=frame.against_surface,
        folded=frame.folded,
        self_intersections=frame.self_intersections,
        least_angle_deg=frame.least_angle_deg,
        below_20_deg_percent=frame.below_20_deg_percent,
        area_ratio_min=frame.area_ratio_min,
        area_ratio_max=frame.area_ratio_max,
        step_mean_mm=frame.step_mean_mm,
        step_max_mm=frame.step_max_mm,
    )


def _summary(distance: DirectedDistance) -> DistanceSummary:
    return DistanceSummary(
        mean=distance.mean_mm,
        rms=distance.rms_mm,
        p50=distance.p50_mm,
        p90=distance.p90_mm,
        p95=distance.p95_mm,
        max=distance.max_mm,
        count=distance.samples,
    )
