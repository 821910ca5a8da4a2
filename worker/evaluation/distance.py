"""How far two surfaces are apart: exact distances from points to triangles."""

from dataclasses import dataclass

import igl
import numpy as np
from jaxtyping import Int

from schemas.problem import InternalError, ProblemType
from worker.arrays import Points, Scalars
from worker.evaluation.kept_by_mesh import KeptByMesh
from worker.evaluation.surface_samples import area_uniform_samples_mm
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True)
class DirectedDistance:
    """Distances from samples of one surface to the nearest points of another, mm.

    Of that surface itself, or of the samples that stand for it: the owner of the value says which.
    """

    mean_mm: float
    rms_mm: float
    p50_mm: float
    p90_mm: float
    p95_mm: float
    max_mm: float
    samples: int


@dataclass(frozen=True)
class SurfaceDistance:
    """Exact distances between a surface and its reference, both ways, mm.

    mean_mm, rms_mm: over both directions, each direction weighing the same.
    hausdorff95_mm, hausdorff_mm: the larger of the two directions' 95th percentile and maximum.
        The maximum is that of the samples, a lower bound of the true one and soon close to it.
    """

    mean_mm: float
    rms_mm: float
    hausdorff95_mm: float
    hausdorff_mm: float
    to_reference: DirectedDistance
    from_reference: DirectedDistance


@dataclass(frozen=True, eq=False)
class PointDistances:
    """Points (n, 3) of one surface, mm, and their exact distances (n,) to another, mm."""

    points_mm: Points
    distances_mm: Scalars


class _Tree:
    """A mesh's bounding-box tree, in the exact types and layout that libigl takes."""

    def __init__(self, mesh: SurfaceMesh) -> None:
        self._vertices = np.ascontiguousarray(mesh.vertices_mm, dtype=np.float64)
        self._faces = np.ascontiguousarray(mesh.faces, dtype=np.int64)
        self._boxes = igl.AABB()
        self._boxes.init(self._vertices, self._faces)

    def nearest(self, points_mm: Points) -> tuple[Scalars, Int[np.ndarray, " n"], Points]:
        """Distances, faces and places of the nearest points of the mesh."""
        points = np.ascontiguousarray(points_mm, dtype=np.float64)
        squared, face, places = self._boxes.squared_distance(self._vertices, self._faces, points)
        distances: Scalars = np.sqrt(np.maximum(squared, 0.0))
        return distances, face.astype(np.int64), places


_TREES: KeptByMesh[_Tree] = KeptByMesh()
"""A report asks for the distance of every outline by itself, and the tree takes longer than the
query."""

_BETWEEN: KeptByMesh[KeptByMesh[Scalars]] = KeptByMesh()
"""From the vertices of one mesh to another: a wall's thickness is a field and a table."""


def points_to_surface_mm(points_mm: Points, mesh: SurfaceMesh) -> Scalars:
    """Exact distance from each of (n, 3) points to the nearest triangle of `mesh`, (n,) mm.

    Raises InternalError when the mesh has no faces.
    """
    tree = _tree(mesh)
    return tree.nearest(points_mm)[0] if len(points_mm) else np.zeros(0)


def vertices_to_surface_mm(mesh: SurfaceMesh, other: SurfaceMesh) -> Scalars:
    """Exact distance from each vertex of `mesh` to the nearest triangle of `other`, (n,) mm. It is
    kept for as long as both are in use: not to be written to. Raises InternalError when the other
    has no faces.
    """

    def found(target: SurfaceMesh) -> Scalars:
        distances_mm = points_to_surface_mm(mesh.vertices_mm, target)
        distances_mm.flags.writeable = False
        return distances_mm

    return _BETWEEN.of(mesh, lambda _: KeptByMesh()).of(other, found)


def nearest_on_surface(
    points_mm: Points, mesh: SurfaceMesh
) -> tuple[Points, Int[np.ndarray, " n"]]:
    """The nearest point of `mesh` to each of (n, 3) points, n at least 1: where it is, (n, 3) mm,
    and in which face, (n,). Raises InternalError when the mesh has no faces.
    """
    _, faces, places = _tree(mesh).nearest(points_mm)
    return places, faces


def _tree(mesh: SurfaceMesh) -> _Tree:
    if not len(mesh.faces):
        raise InternalError(
            ProblemType.NO_SURFACE, "The mesh has no triangles to measure a distance to."
        )
    return _TREES.of(mesh, _Tree)


def surface_to_surface(
    mesh: SurfaceMesh, reference: SurfaceMesh, samples: int = 20_000, seed: int = 0
) -> SurfaceDistance:
    """Distances from `samples` area-uniform points of each surface to the other's triangles.

    Deterministic in `seed`. Raises InternalError when either mesh has no faces.
    """
    return summarised_both_ways(*distances_both_ways(mesh, reference, samples, seed))


def distances_both_ways(
    mesh: SurfaceMesh, reference: SurfaceMesh, samples: int = 20_000, seed: int = 0
) -> tuple[PointDistances, PointDistances]:
    """What `surface_to_surface` summarises: points of `mesh` measured to the reference, and points
    of the reference measured to `mesh`.
    """
    generator = np.random.default_rng(seed)
    own, other = (area_uniform_samples_mm(one, samples, generator) for one in (mesh, reference))
    return (
        PointDistances(own, points_to_surface_mm(own, reference)),
        PointDistances(other, points_to_surface_mm(other, mesh)),
    )


def summarised_both_ways(there: PointDistances, back: PointDistances) -> SurfaceDistance:
    """Both directions, to the reference and from it, in a few numbers."""
    to_reference, from_reference = directed(there.distances_mm), directed(back.distances_mm)
    return SurfaceDistance(
        mean_mm=(to_reference.mean_mm + from_reference.mean_mm) / 2.0,
        rms_mm=float(np.sqrt((to_reference.rms_mm**2 + from_reference.rms_mm**2) / 2.0)),
        hausdorff95_mm=max(to_reference.p95_mm, from_reference.p95_mm),
        hausdorff_mm=max(to_reference.max_mm, from_reference.max_mm),
        to_reference=to_reference,
        from_reference=from_reference,
    )


def directed(distances_mm: Scalars) -> DirectedDistance:
    """Distances (n,) of one direction, at least one and none negative, in a few numbers."""
    return DirectedDistance(
        mean_mm=float(distances_mm.mean()),
        rms_mm=float(np.sqrt(np.mean(distances_mm**2))),
        p50_mm=float(np.percentile(distances_mm, 50.0)),
        p90_mm=float(np.percentile(distances_mm, 90.0)),
        p95_mm=float(np.percentile(distances_mm, 95.0)),
        max_mm=float(distances_mm.max()),
        samples=len(distances_mm),
    )
