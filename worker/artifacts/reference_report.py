"""One surface of one frame held against its reference."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

from schemas.measures import DistanceSummary
from schemas.options import ReferenceOptions
from schemas.problem import InputError, InternalError, ProblemType
from schemas.reference_report import (
    CurvatureReport,
    PlacementReport,
    PointSetReport,
    ReferenceReport,
    Region,
)
from worker.arrays import Scalars
from worker.artifacts.reference_planes import ViewPlane, planes_by_view
from worker.evaluation.area_share import area_above_percentile_percent, vertex_areas_mm2
from worker.evaluation.comparison import closed_volume_ml, volume_difference_percent
from worker.evaluation.curvature_comparison import compare_curvature
from worker.evaluation.distance import (
    PointDistances,
    distances_both_ways,
    summarised_both_ways,
    vertices_to_surface_mm,
)
from worker.evaluation.point_set_distance import PointSetDistance, point_set_distance
from worker.evaluation.regions import Regions
from worker.evaluation.rigid_placement import RigidPlacement, rigid_placement
from worker.evaluation.size import triangle_areas_mm2
from worker.evaluation.summary import summarised
from worker.evaluation.surface_normals import normals_at
from worker.observer import Cancelled, Observer, Unobserved
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True, eq=False)
class MeasuredReference:
    """A reference, and what was measured against it.

    reference: as it was measured: given as it is, or, where the surface was to be laid onto it,
        moved back by that motion; so the surface, its slices and its regions stay where they are.
    distance_mm: (n,) exact distances from the surface's vertices to that reference.
    """

    report: ReferenceReport
    reference: SurfaceMesh
    distance_mm: Scalars


def reference_report(
    mesh: SurfaceMesh,
    reference: SurfaceMesh,
    *,
    regions: Regions,
    planes: Sequence[ViewPlane],
    options: ReferenceOptions,
    seed: int,
    observer: Observer | None = None,
) -> MeasuredReference:
    """Measure a surface against its reference, both in mm and in one frame, closed ones outward.

    regions: of the surface. planes: of its frame's slices after alignment. Deterministic in `seed`.

    Raises:
        InputError: for a reference without area.
        InternalError: for a surface without area.
        Cancelled: when the observer says so, who is asked between all parts.
    """
    watcher = observer or Unobserved()
    _refuse_without_area(mesh, reference)
    placement = None
    if options.align:
        placement = rigid_placement(mesh, reference, watcher)
        reference = placement.moved_back(reference)
    _look(watcher)
    own_ml, reference_ml = closed_volume_ml(mesh), closed_volume_ml(reference)
    difference_percent = volume_difference_percent(own_ml, reference_ml)
    distance_mm = vertices_to_surface_mm(mesh, reference)
    _look(watcher)
    there, back = distances_both_ways(mesh, reference, options.samples, seed)
    exact = summarised_both_ways(there, back)
    _look(watcher)
    points = point_set_distance(there.points_mm, back.points_mm)
    _look(watcher)
    reasons = dict(regions.not_split)
    either_open = _open(own_ml, reference_ml)
    if reference_ml is None:
        reasons["volume_ml"] = "The reference is open."
    if difference_percent is None:
        reasons["volume_difference_percent"] = either_open or "The reference encloses nothing."
    if either_open:
        reasons["by_view"] = either_open
    curvature = _curvature(mesh, reference, regions, options, watcher, either_open)
    if isinstance(curvature, str):
        reasons["curvature"] = curvature
    report = ReferenceReport(
        volume_ml=reference_ml,
        volume_difference_percent=difference_percent,
        mean_mm=exact.mean_mm,
        rms_mm=exact.rms_mm,
        hausdorff95_mm=exact.hausdorff95_mm,
        hausdorff_mm=exact.hausdorff_mm,
        to_reference_mm=summarised(there.distances_mm),
        from_reference_mm=summarised(back.distances_mm),
        by_region_mm=_by_region(there, mesh, regions),
        above_p90_area_percent=area_above_percentile_percent(
            vertex_areas_mm2(mesh), distance_mm, 90.0
        ),
        by_view={} if either_open else planes_by_view(mesh, reference, planes, watcher),
        point_set=_point_set(points, options.samples),
        curvature=None if isinstance(curvature, str) else curvature,
        placement=_placement(placement) if placement else None,
        not_measured=reasons,
    )
    return MeasuredReference(report, reference, distance_mm)


def _refuse_without_area(mesh: SurfaceMesh, reference: SurfaceMesh) -> None:
    """Points cannot be spread over nothing."""
    if not triangle_areas_mm2(mesh).sum() > 0.0:
        raise InternalError(
            ProblemType.NO_SURFACE, "The surface has no area to measure; reconstruct it again."
        )
    if not triangle_areas_mm2(reference).sum() > 0.0:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "The reference has no triangle with area; send the surface itself.",
        )


def _open(own_ml: float | None, reference_ml: float | None) -> str | None:
    """Why nothing can be measured that needs both surfaces closed; None where both are."""
    if own_ml is None:
        return "The surface is open; ask for a closed base."
    return "The reference is open; send a closed one." if reference_ml is None else None


def _look(observer: Observer) -> None:
    if observer.is_cancelled():
        raise Cancelled


def _by_region(
    there: PointDistances, mesh: SurfaceMesh, regions: Regions
) -> dict[Region, DistanceSummary]:
    normals = normals_at(there.points_mm, mesh)
    parts = {
        name: there.distances_mm[part(there.points_mm, normals)]
        for name, part in regions.parts.items()
    }
    return {name: summarised(part) for name, part in parts.items() if len(part)}


def _curvature(
    mesh: SurfaceMesh,
    reference: SurfaceMesh,
    regions: Regions,
    options: ReferenceOptions,
    observer: Observer,
    either_open: str | None,
) -> CurvatureReport | str:
    """How differently both bend, or why it is not compared."""
    edge_mm = options.curvature_edge_mm
    if edge_mm is None:
        return "Not asked for; set `reference.curvature_edge_mm`."
    if either_open:
        return either_open
    try:
        found = compare_curvature(mesh, reference, edge_mm, observer, regions.parts)
    except InternalError as error:
        return error.detail
    return CurvatureReport.model_validate(asdict(found))


def _point_set(found: PointSetDistance, points: int) -> PointSetReport:
    """Without the directed distances, of which the report has the exact ones."""
    numbers = {name: part for name, part in asdict(found).items() if isinstance(part, float)}
    return PointSetReport.model_validate({"points": points} | numbers)


def _placement(found: RigidPlacement) -> PlacementReport:
    x, y, z = found.translation_mm.tolist()
    return PlacementReport(rotation_deg=found.rotation_deg, translation_mm=(x, y, z))
