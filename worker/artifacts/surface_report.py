"""One surface of one frame, measured."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Literal

import numpy as np

from schemas.report import (
    DistanceSummary,
    EndReport,
    QualityReport,
    SurfaceReport,
    ViewResiduals,
)
from schemas.vocabulary import Structure, View
from worker.arrays import Scalars, Vector
from worker.artifacts.simulation_gate import SurfaceFaults, simulation_report
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.extrapolation import SurfaceEnd, slice_gap_mm, surface_ends
from worker.evaluation.quality import triangle_quality
from worker.evaluation.residuals import Residuals, all_distances_mm, by_thirds
from worker.evaluation.size import area_cm2, volume_ml
from worker.evaluation.summary import histogram, summarised
from worker.evaluation.support import area_beyond_percent, distance_to_outlines_mm
from worker.evaluation.topology import (
    boundary_loop_count,
    component_count,
    euler_number,
    is_manifold,
    is_watertight,
)
from worker.evaluation.triangle_crossings import self_intersections
from worker.surface_mesh import SurfaceMesh

_View = Literal["short_axis", "long_axis", "other"]
_Region = Literal["apex", "mid", "base"]

_SAMPLES = 10_000
"""Points measured on either surface for the distance that remeshing made."""


def surface_report(
    mesh: SurfaceMesh,
    unremeshed: SurfaceMesh | None,
    residuals: Sequence[Residuals],
    toward_base: Vector | None,
    crossing: Mapping[Structure, int],
    files: Sequence[str],
    *,
    open_base: bool,
) -> SurfaceReport:
    """Size, topology, triangles, residuals and support of a surface.

    Args:
        mesh: The surface, in mm.
        unremeshed: What it was before remeshing, if it was remeshed.
        residuals: Of the outlines that it was observed by, aligned.
        toward_base: (3,) the short-axis normal from apex to base, None when there is none.
        crossing: How many of its triangles pass through each other surface.
        files: Names of its files.
        open_base: Whether it is meant to have a rim at the valves.

    Raises:
        InternalError: for a surface that faces inward, or that no contour was observed of.
    """
    watertight = is_watertight(mesh)
    outlines = [one.outline for one in residuals]
    quality = _quality(mesh)
    faults = SurfaceFaults(
        open_base=open_base,
        rims=boundary_loop_count(mesh),
        manifold=is_manifold(mesh),
        components=component_count(mesh),
        euler_number=euler_number(mesh),
        self_intersecting=len(np.unique(self_intersections(mesh))),
        crossing=crossing,
        sliver_percent=quality.below_20_deg_percent,
        remeshed=unremeshed is not None,
    )
    support_mm = distance_to_outlines_mm(mesh.vertices_mm, outlines)
    gap_mm, ends = None, None
    if toward_base is not None:
        gap_mm = slice_gap_mm(toward_base, outlines)
        ends = surface_ends(mesh, support_mm, toward_base, outlines)
    return SurfaceReport(
        volume_ml=volume_ml(mesh) if watertight else None,
        area_cm2=area_cm2(mesh),
        watertight=watertight,
        vertices=len(mesh.vertices_mm),
        faces=len(mesh.faces),
        euler_number=faults.euler_number,
        components=faults.components,
        manifold=faults.manifold,
        self_intersecting_triangles=faults.self_intersecting,
        crossing_triangles=dict(crossing),
        simulation=simulation_report(faults),
        contour_residual_mm=summarised(all_distances_mm(residuals)),
        contour_residual_by_view=_by_view(residuals),
        contour_residual_by_region_mm=_by_region(residuals, mesh, toward_base),
        quality=quality,
        quality_before_remeshing=_quality(unremeshed) if unremeshed else None,
        remeshing_distance_mm=_distance(mesh, unremeshed) if unremeshed else None,
        support_mm=summarised(support_mm),
        slice_gap_mm=gap_mm,
        beyond_slice_gap_percent=(
            None if gap_mm is None else area_beyond_percent(mesh, support_mm, gap_mm)
        ),
        apex=_end(ends[0]) if ends else None,
        base=_end(ends[1]) if ends else None,
        files=list(files),
    )


_VIEWS: Mapping[_View, Callable[[View], bool]] = {
    "short_axis": lambda view: view is View.SAX,
    "long_axis": lambda view: view.is_long_axis,
    "other": lambda view: view is View.OTHER,
}


def _by_view(residuals: Sequence[Residuals]) -> dict[_View, ViewResiduals]:
    parts = {
        name: all_distances_mm([one for one in residuals if is_such(one.outline.view)])
        for name, is_such in _VIEWS.items()
    }
    return {
        name: ViewResiduals(summary_mm=summarised(part), histogram=histogram(part))
        for name, part in parts.items()
        if len(part)
    }


def _by_region(
    residuals: Sequence[Residuals], mesh: SurfaceMesh, toward_base: Vector | None
) -> dict[_Region, DistanceSummary]:
    if toward_base is None:
        return {}
    apex, mid, base = by_thirds(residuals, mesh, toward_base)
    parts: dict[_Region, Scalars] = {"apex": apex, "mid": mid, "base": base}
    return {name: summarised(part) for name, part in parts.items() if len(part)}


def _quality(mesh: SurfaceMesh) -> QualityReport:
    """JSON knows no infinity, which is the aspect ratio of a triangle without area."""
    found = asdict(triangle_quality(mesh))
    return QualityReport(**{k: v if math.isfinite(v) else None for k, v in found.items()})


def _distance(mesh: SurfaceMesh, unremeshed: SurfaceMesh) -> DistanceSummary:
    found = surface_to_surface(mesh, unremeshed, _SAMPLES)
    return DistanceSummary(
        mean=found.mean_mm,
        rms=found.rms_mm,
        p50=max(found.to_reference.p50_mm, found.from_reference.p50_mm),
        p90=max(found.to_reference.p90_mm, found.from_reference.p90_mm),
        p95=found.hausdorff95_mm,
        max=found.hausdorff_mm,
        count=found.to_reference.samples + found.from_reference.samples,
    )


def _end(end: SurfaceEnd) -> EndReport:
    return EndReport(**asdict(end))
