"""How differently two closed surfaces bend: curvature against curvature, on even triangles.

Discrete curvature depends on the triangles, so both surfaces are first remeshed to one edge length,
each onto itself. Then every vertex of the reference is paired with the nearest point of the other
surface (not its nearest vertex), where the curvature is interpolated over the triangle.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import igl
import numpy as np
from jaxtyping import Float, Int

from schemas.problem import InternalError, ProblemType
from schemas.reference_report import Region
from worker.arrays import Flags, Points, Scalars, SomePoints, SomeScalars
from worker.evaluation.area_share import area_above_percentile_percent
from worker.evaluation.curvature import VertexCurvature, gauss_bonnet_residual, vertex_curvature
from worker.evaluation.distance import nearest_on_surface
from worker.evaluation.regions import InRegion
from worker.evaluation.surface_normals import vertex_normals
from worker.observer import Observer, Unobserved
from worker.remeshing.remeshing import remesh
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True)
class CurvatureDeviation:
    """Curvature of the reference minus that of the surface, over the reference's vertices.

    mean_abs, rms: of the deviations' amounts, weighed by the area of each vertex.
    p75_abs, p90_abs: percentiles of the amounts over the vertices.
    reference_rms: of the reference's own curvature, to hold them against.
    above_p75_area_percent: share of the reference's area whose deviation is above the 75th
    percentile of its vertices (the paper's "75th percentile region").
    mean_abs_by_region: mean_abs over the reference's vertices in each region that has one, by name.
    """

    mean_abs: float
    rms: float
    p75_abs: float
    p90_abs: float
    reference_rms: float
    above_p75_area_percent: float
    mean_abs_by_region: dict[str, float]


@dataclass(frozen=True)
class CurvatureComparison:
    """Gaussian (1/mm2) and mean (1/mm) curvature, and the edge length that both surfaces have.

    gauss_bonnet_residual_rad: what the angle deficits of both sum to beyond 2 pi chi, the larger:
    rounding, if all is well.
    """

    edge_mm: float
    gaussian_per_mm2: CurvatureDeviation
    mean_per_mm: CurvatureDeviation
    gauss_bonnet_residual_rad: float


def compare_curvature(
    mesh: SurfaceMesh,
    reference: SurfaceMesh,
    edge_mm: float = 2.0,
    observer: Observer | None = None,
    regions: Mapping[Region, InRegion] | None = None,
) -> CurvatureComparison:
    """Both closed and outward, in mm and one frame. Source: NeuralMRI (arXiv 2603.27003), whose
    deviation is reference minus prediction; its areas are barycentric Voronoi, ours mixed (Meyer et
    al. 2003). regions: parts of the reference to take means over, too.

    Raises InternalError for a surface that is not closed, or too small or thin for this edge
    length; Cancelled when the observer says so.
    """
    watcher = observer or Unobserved()
    own, other = (_evenly_meshed(one, edge_mm, watcher) for one in (mesh, reference))
    bend, true = vertex_curvature(own), vertex_curvature(other)
    places, faces = nearest_on_surface(other.vertices_mm, own)
    weights = _barycentric(places, own, faces)
    normals = vertex_normals(other)
    parts = {name: part(other.vertices_mm, normals) for name, part in (regions or {}).items()}

    def deviation(ours: SomeScalars, theirs: SomeScalars) -> CurvatureDeviation:
        met = np.einsum("nc,nc->n", ours[own.faces[faces]], weights)
        return _summary(theirs - met, theirs, true, parts)

    return CurvatureComparison(
        edge_mm=edge_mm,
        gaussian_per_mm2=deviation(bend.gaussian_per_mm2, true.gaussian_per_mm2),
        mean_per_mm=deviation(bend.mean_per_mm, true.mean_per_mm),
        gauss_bonnet_residual_rad=max(abs(gauss_bonnet_residual(one)) for one in (own, other)),
    )


def _evenly_meshed(mesh: SurfaceMesh, edge_mm: float, observer: Observer) -> SurfaceMesh:
    def onto_surface(points_mm: SomePoints) -> SomePoints:
        return nearest_on_surface(points_mm, mesh)[0]

    try:
        vertices, faces = remesh(mesh.vertices_mm, mesh.faces, edge_mm, onto_surface, observer)
    except ValueError as error:
        raise _too_coarse() from error
    return SurfaceMesh(vertices, faces)


def _too_coarse() -> InternalError:
    """What is left of a surface that is hardly larger or thicker than an edge."""
    return InternalError(
        ProblemType.NO_SURFACE,
        "The surface is too small or too thin for triangles of this edge length to show how it "
        "bends; set `reference.curvature_edge_mm` to a shorter length.",
    )


def _barycentric(
    places_mm: Points, mesh: SurfaceMesh, faces: Int[np.ndarray, " n"]
) -> Float[np.ndarray, "n 3"]:
    a, b, c = (
        np.ascontiguousarray(mesh.vertices_mm[mesh.faces[faces, corner]]) for corner in range(3)
    )
    weights: np.ndarray = igl.barycentric_coordinates(np.ascontiguousarray(places_mm), a, b, c)
    return weights


def _summary(
    deviation: Scalars, theirs: Scalars, true: VertexCurvature, parts: Mapping[Region, Flags]
) -> CurvatureDeviation:
    """A vertex counts as much as the area about it; one without area has no curvature."""
    known = np.isfinite(deviation) & (true.area_mm2 > 0.0)
    if not known.any():
        raise _too_coarse()
    amount, areas = np.abs(deviation[known]), true.area_mm2[known]

    def mean(of: np.ndarray, where: np.ndarray | slice = slice(None)) -> float:
        return float(of[where] @ areas[where] / areas[where].sum())

    return CurvatureDeviation(
        mean_abs=mean(amount),
        rms=float(np.sqrt(mean(amount**2))),
        p75_abs=float(np.percentile(amount, 75.0)),
        p90_abs=float(np.percentile(amount, 90.0)),
        reference_rms=float(np.sqrt(mean(theirs[known] ** 2))),
        above_p75_area_percent=area_above_percentile_percent(areas, amount, 75.0),
        mean_abs_by_region={
            name: mean(amount, part[known]) for name, part in parts.items() if part[known].any()
        },
    )
