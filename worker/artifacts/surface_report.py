"""One surface of one frame, measured."""

import math
from collections.abc import Sequence
from dataclasses import asdict

from schemas.report import (
    DistanceSummary,
    EndReport,
    QualityReport,
    SurfaceReport,
)
from worker.arrays import Scalars, Vector
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.extrapolation import SurfaceEnd, slice_gap_mm, surface_ends
from worker.evaluation.quality import triangle_quality
from worker.evaluation.size import area_cm2, volume_ml
from worker.evaluation.summary import summarised
from worker.evaluation.support import (
    AlignedOutline,
    area_beyond_percent,
    distance_to_outlines_mm,
)
from worker.evaluation.topology import euler_number, is_watertight
from worker.surface_mesh import SurfaceMesh

_SAMPLES = 10_000
"""Points measured on either surface for the distance that remeshing made."""


def surface_report(
    mesh: SurfaceMesh,
    unremeshed: SurfaceMesh | None,
    residuals_mm: Scalars,
    outlines: Sequence[AlignedOutline],
    toward_base: Vector | None,
    files: Sequence[str],
) -> SurfaceReport:
    """Size, topology, triangles, residuals and support of a surface.

    Args:
        mesh: The surface, in mm.
        unremeshed: What it was before remeshing, if it was remeshed.
        residuals_mm: (n,) distances of contour points to it.
        outlines: Where it was observed, aligned.
        toward_base: (3,) the short-axis normal from apex to base, None when there is none.
        files: Names of its files.

    Raises:
        InternalError: for a surface that faces inward, or that no contour was observed of.
    """
    watertight = is_watertight(mesh)
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
        euler_number=euler_number(mesh),
        contour_residual_mm=summarised(residuals_mm),
        quality=_quality(mesh),
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


def _quality(mesh: SurfaceMesh) -> QualityReport:
    """JSON knows no infinity, which is the aspect ratio of a triangle without area."""
    found = asdict(triangle_quality(mesh))
    return QualityReport(**{k: v if math.isfinite(v) else None for k, v in found.items()})


def _distance(mesh: SurfaceMesh, unremeshed: SurfaceMesh) -> DistanceSummary:
    found = surface_to_surface(mesh, unremeshed, _SAMPLES)
    return DistanceSummary(
        mean=found.mean_mm,
        rms=found.rms_mm,
        p95=found.hausdorff95_mm,
        max=found.hausdorff_mm,
        count=found.to_reference.samples + found.from_reference.samples,
    )


def _end(end: SurfaceEnd) -> EndReport:
    return EndReport(**asdict(end))
