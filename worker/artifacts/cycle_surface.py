"""One surface over the cycle: size, bending, strain, and how much of it lies wrong."""

from collections.abc import Sequence

import numpy as np

from schemas.cycle_report import SpreadSeries, SurfaceCycleReport
from schemas.frame_report import FrameReport
from schemas.reference_report import ReferenceReport
from schemas.vocabulary import Structure
from worker.artifacts.cycle_strain import cycle_strain
from worker.artifacts.measured import MeasuredFrame, MeasuredSurface
from worker.artifacts.surface_sizes import areas_cm2, volumes_ml
from worker.evaluation.area_share import vertex_areas_mm2
from worker.evaluation.area_spread import AreaSpread, area_spread
from worker.evaluation.change import change_percent
from worker.tracking.tracked_surface import TrackedSurface

_WALL = (Structure.LV_ENDO, Structure.LV_EPI)

MeasuredFrames = Sequence[tuple[FrameReport, MeasuredFrame]]


def surface_cycle(
    measured: MeasuredFrames, structure: Structure, since: int, tracked: TrackedSurface | None
) -> SurfaceCycleReport:
    """Of frames in order of time, some of which have the surface. since: index of end-diastole."""
    frames = [report for report, _ in measured]
    references = [
        frame.surfaces[structure].reference if structure in frame.surfaces else None
        for frame in frames
    ]
    areas = areas_cm2(frames, structure)
    labels = [frame.label for frame in frames]
    strain = cycle_strain(tracked, labels, labels[since]) if tracked else None
    ventricle = measured[since][1].ventricle if structure in _WALL else None
    return SurfaceCycleReport(
        volume_ml=volumes_ml(frames, structure),
        area_cm2=areas,
        area_change_percent=change_percent(areas, since),
        gaussian_curvature_per_mm2=_field(measured, structure, "gaussian_curvature_per_mm2"),
        mean_curvature_per_mm=_field(measured, structure, "mean_curvature_per_mm"),
        area_strain_percent=_series(strain.spread()) if strain else None,
        area_strain_by_segment_percent=(
            strain.by_segment(ventricle) if strain and ventricle else None
        ),
        above_p90_error_area_percent=[one and one.above_p90_area_percent for one in references],
        above_p75_curvature_area_percent=[_bent_otherwise_percent(one) for one in references],
    )


def _bent_otherwise_percent(reference: ReferenceReport | None) -> float | None:
    if reference is None or reference.curvature is None:
        return None
    return reference.curvature.gaussian_per_mm2.above_p75_area_percent


def _field(measured: MeasuredFrames, structure: Structure, name: str) -> SpreadSeries:
    found = [frame.surfaces.get(structure) for _, frame in measured]
    return _series([None if one is None else _spread(one, name) for one in found])


def _spread(surface: MeasuredSurface, name: str) -> AreaSpread | None:
    """Of a field, over the vertices where it is a number: a level set without a slope has none."""
    values = surface.fields.get(name)
    if values is None:
        return None
    known = np.isfinite(values)
    if not known.any():
        return None
    return area_spread(vertex_areas_mm2(surface.mesh)[known], values[known])


def _series(found: Sequence[AreaSpread | None]) -> SpreadSeries:
    return SpreadSeries(
        mean=[one and one.mean for one in found],
        p5=[one and one.p5 for one in found],
        p50=[one and one.p50 for one in found],
        p95=[one and one.p95 for one in found],
    )
