"""One surface of one frame, measured."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict

import numpy as np

from schemas.measures import DistanceSummary
from schemas.reference_report import ReferenceReport
from schemas.surface_report import (
    EndReport,
    QualityReport,
    SurfaceReport,
    Third,
    ViewResiduals,
)
from schemas.vocabulary import Structure, ViewKind
from worker.arrays import Scalars, Vector
from worker.artifacts.held_out import HeldOut
from worker.artifacts.measured import MeasuredSurface
from worker.artifacts.simulation_gate import SurfaceFaults, simulation_report
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.extrapolation import SurfaceEnd, slice_gap_mm, surface_ends
from worker.evaluation.quality import triangle_quality
from worker.evaluation.residuals import Residuals, all_distances_mm, by_thirds
from worker.evaluation.size import area_cm2, volume_ml
from worker.evaluation.summary import histogram, summarised
from worker.evaluation.support import area_beyond_percent
from worker.evaluation.topology import (
    boundary_loop_count,
    component_count,
    euler_number,
    is_manifold,
    is_watertight,
)
from worker.evaluation.triangle_crossings import self_intersections
from worker.surface_mesh import SurfaceMesh

_SAMPLES = 10_000
"""Points measured on either surface for the distance that remeshing made."""


def surface_report(
    surface: MeasuredSurface,
    unremeshed: SurfaceMesh | None,
    toward_base: Vector | None,
    crossing: Mapping[Structure, int],
    held_out: Sequence[HeldOut],
    reference: ReferenceReport | None,
    files: Sequence[str],
    *,
    open_base: bool,
) -> SurfaceReport:
    """Size, topology, triangles, residuals, support and errors of a surface.

    Args:
        surface: In mm, with what is known at its vertices and its contour points.
        unremeshed: What it was before remeshing, if it was remeshed.
        toward_base: (3,) the short-axis normal from apex to base, None when there is none.
        crossing: How many of its triangles pass through each other surface.
        held_out: Of its contours in slices that it was fitted without.
        reference: What it was held against.
        files: Names of its files.
        open_base: Whether it is meant to have a rim at the valves.

    Raises:
        InternalError: for a surface that faces inward, or that no contour was observed of.
    """
    mesh, fields, residuals = surface.mesh, surface.fields, surface.residuals
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
    support_mm = fields["support_mm"]
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
        held_out_mm=(
            summarised(np.concatenate([one.distances_mm for one in held_out])) if held_out else None
        ),
        held_out_by_view_mm=_held_out_by_view(held_out),
        deviation_mm=summarised(fields["deviation_mm"]) if "deviation_mm" in fields else None,
        reference=reference,
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


def _by_view(residuals: Sequence[Residuals]) -> dict[ViewKind, ViewResiduals]:
    parts: dict[ViewKind, list[Residuals]] = {}
    for one in residuals:
        parts.setdefault(one.outline.view.kind, []).append(one)
    distances = {kind: all_distances_mm(part) for kind, part in parts.items()}
    return {
        kind: ViewResiduals(summary_mm=summarised(part), histogram=histogram(part))
        for kind, part in distances.items()
    }


def _held_out_by_view(held_out: Sequence[HeldOut]) -> dict[ViewKind, DistanceSummary]:
    parts: dict[ViewKind, list[Scalars]] = {}
    for one in held_out:
        parts.setdefault(one.view.kind, []).append(one.distances_mm)
    return {kind: summarised(np.concatenate(part)) for kind, part in parts.items()}


def _by_region(
    residuals: Sequence[Residuals], mesh: SurfaceMesh, toward_base: Vector | None
) -> dict[Third, DistanceSummary]:
    if toward_base is None:
        return {}
    apex, mid, base = by_thirds(residuals, mesh, toward_base)
    parts: dict[Third, Scalars] = {"apex": apex, "mid": mid, "base": base}
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
