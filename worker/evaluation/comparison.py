"""A surface held against its reference: everything that is measured between two meshes."""

from dataclasses import dataclass

from worker.evaluation.curvature_comparison import CurvatureComparison, compare_curvature
from worker.evaluation.distance import (
    SurfaceDistance,
    distances_both_ways,
    summarised_both_ways,
)
from worker.evaluation.point_set_distance import PointSetDistance, point_set_distance
from worker.evaluation.quality import TriangleQuality, triangle_quality
from worker.evaluation.size import area_cm2, signed_volume_ml
from worker.evaluation.topology import component_count, euler_number, is_watertight
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True)
class SurfaceFacts:
    """One surface by itself. volume_ml is None when the surface is not closed."""

    volume_ml: float | None
    area_cm2: float
    watertight: bool
    euler_number: int
    components: int
    vertices: int
    faces: int
    quality: TriangleQuality


@dataclass(frozen=True)
class Comparison:
    """A surface, its reference, and their distances.

    surface_distance is exact and is the one to judge by; point_set_distance is the method's own
    form, between as many points drawn independently on either surface. curvature is None where it
    was not asked for, or a surface is not closed.
    """

    mesh: SurfaceFacts
    reference: SurfaceFacts
    volume_difference_percent: float | None
    surface_distance: SurfaceDistance
    point_set_distance: PointSetDistance
    curvature: CurvatureComparison | None
    samples: int
    seed: int


def compared(
    mesh: SurfaceMesh,
    reference: SurfaceMesh,
    samples: int = 20_000,
    seed: int = 0,
    curvature_edge_mm: float | None = None,
) -> Comparison:
    """Measures `mesh` against `reference`, both in mm and in one frame.

    curvature_edge_mm: edge length to which both are remeshed to compare how they bend.

    Deterministic in `seed`. Raises InternalError when either mesh has no faces.
    """
    own, other = surface_facts(mesh), surface_facts(reference)
    there, back = distances_both_ways(mesh, reference, samples, seed)
    curvature = None
    if curvature_edge_mm is not None and own.watertight and other.watertight:
        curvature = compare_curvature(mesh, reference, curvature_edge_mm)
    return Comparison(
        mesh=own,
        reference=other,
        volume_difference_percent=volume_difference_percent(own.volume_ml, other.volume_ml),
        surface_distance=summarised_both_ways(there, back),
        point_set_distance=point_set_distance(there.points_mm, back.points_mm),
        curvature=curvature,
        samples=samples,
        seed=seed,
    )


def surface_facts(mesh: SurfaceMesh) -> SurfaceFacts:
    """Size, topology and triangle quality of a mesh that has faces, whichever way it faces."""
    volume_ml = closed_volume_ml(mesh)
    return SurfaceFacts(
        volume_ml=volume_ml,
        area_cm2=area_cm2(mesh),
        watertight=volume_ml is not None,
        euler_number=euler_number(mesh),
        components=component_count(mesh),
        vertices=len(mesh.vertices_mm),
        faces=len(mesh.faces),
        quality=triangle_quality(mesh),
    )


def closed_volume_ml(mesh: SurfaceMesh) -> float | None:
    """What a closed surface encloses, whichever way it faces, mL; None for one that is not."""
    return abs(signed_volume_ml(mesh)) if is_watertight(mesh) else None


def volume_difference_percent(own_ml: float | None, reference_ml: float | None) -> float | None:
    """A surface's volume less its reference's, of the reference's, percent; None where either is
    open or the reference encloses nothing.
    """
    if own_ml is None or not reference_ml:
        return None
    return 100.0 * (own_ml - reference_ml) / reference_ml
