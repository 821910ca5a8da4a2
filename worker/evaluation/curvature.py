"""How a surface bends at each of its vertices, and whether the angles add up.

The operators of Meyer, Desbrun, Schröder and Barr, "Discrete Differential-Geometry Operators for
Triangulated 2-Manifolds" (2003). They read the mesh itself: on one straight out of marching cubes
they measure its triangles more than its surface, so compare meshes of even, equal edge length. Even
then single vertices keep an error where triangles change shape or number around them; means over
many vertices, weighted by area, converge.
"""

from dataclasses import dataclass

import igl
import numpy as np
from jaxtyping import Bool, Float

from worker.arrays import Flags, Points, Scalars
from worker.evaluation.topology import euler_number
from worker.surface_mesh import SurfaceMesh

_NO_AREA = 1e-9
"""A triangle whose doubled area is below this share of its longest edge squared has no area: the
direction of its normal, and no less its cotangents, would be rounding."""

_TrianglesWithArea = Bool[np.ndarray, " m"]

_Angles = Float[np.ndarray, "m 3"]


@dataclass(frozen=True, eq=False)
class VertexCurvature:
    """Curvature at the n vertices of a mesh.

    gaussian_per_mm2: (n,) Gaussian curvature, 1/mm2: the angle deficit over the mixed area.
    mean_per_mm: (n,) mean of the principal curvatures, 1/mm; positive where the surface is convex
        seen from outside: 1/r on an outward sphere of radius r.
    Both are NaN (mask them before a mean: a report holds no NaN) on a rim, where half of the
        neighbourhood is missing, and at a vertex without a triangle that has area.
    area_mm2: (n,) mixed Voronoi area, positive, or 0 at a vertex without a triangle that has area.
        Together they are the area of the mesh.
    deficit: (n,) angle deficit, radians: 2 pi less the sum of the angles at the vertex, on a rim
        pi less the sum; 0 for a vertex in no triangle.
    on_rim: (n,) whether the vertex is on an edge that belongs to one triangle only.
    """

    gaussian_per_mm2: Scalars
    mean_per_mm: Scalars
    area_mm2: Scalars
    deficit: Scalars
    on_rim: Flags


def vertex_curvature(mesh: SurfaceMesh) -> VertexCurvature:
    """Gaussian and mean curvature at each vertex of a mesh, closed or with rims.

    Triangles without area are bridged: their angles count as the limit of thin triangles, their
    area does not, and for the mean curvature they lie flat in what surrounds them. Vertices that
    coincide have one deficit between them, and how it is divided means nothing.
    """
    with_area = _with_area(mesh)
    area = _mixed_areas_mm2(mesh, with_area)
    deficit, on_rim = _deficits(mesh)
    whole = ~on_rim & (area > 0.0)
    gaussian, mean = np.full((2, len(area)), np.nan)
    np.divide(deficit, area, out=gaussian, where=whole)
    np.divide(_signed_gradients_mm(mesh, with_area), 2.0 * area, out=mean, where=whole)
    return VertexCurvature(gaussian, mean, area, deficit, on_rim)


def gauss_bonnet_residual(mesh: SurfaceMesh) -> float:
    """Sum of the angle deficits less 2 pi times the Euler number, radians: 0 but for rounding.

    True of every mesh, with rims, forks or triangles without area (theorem of Gauss and Bonnet).
    """
    deficit, _ = _deficits(mesh)
    return float(deficit.sum() - 2.0 * np.pi * euler_number(mesh))


def _with_area(mesh: SurfaceMesh) -> _TrianglesWithArea:
    edges = mesh.triangles_mm - np.roll(mesh.triangles_mm, 1, axis=1)
    longest_squared = (edges**2).sum(axis=2).max(axis=1)
    doubled = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    with_area: _TrianglesWithArea = doubled > _NO_AREA * longest_squared
    return with_area


def _mixed_areas_mm2(mesh: SurfaceMesh, with_area: _TrianglesWithArea) -> Scalars:
    """Each vertex's share of its triangles' area, section 3.3 of the paper.

    The part nearer to it than to the other corners; of an obtuse triangle, half for the obtuse
    corner and a quarter for each other.
    """
    areas = np.zeros(len(mesh.vertices_mm))
    if with_area.any():
        # libigl's "Voronoi" masses are just these, obtuse triangles included, but NaN where two
        # corners coincide, and they end with the last vertex in use.
        shares = igl.massmatrix(
            np.ascontiguousarray(mesh.vertices_mm, dtype=np.float64),
            np.ascontiguousarray(mesh.faces[with_area], dtype=np.int64),
            igl.MASSMATRIX_TYPE_VORONOI,
        ).diagonal()
        areas[: len(shares)] = shares
    return areas


def _deficits(mesh: SurfaceMesh) -> tuple[Scalars, Flags]:
    """Angle deficits in radians, and which vertices are on a rim."""
    count = len(mesh.vertices_mm)
    sides = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, times = np.unique(sides, axis=0, return_counts=True)
    edges_around = np.bincount(edges.ravel(), minlength=count)
    faces_around = np.bincount(mesh.faces.ravel(), minlength=count)
    angles = np.bincount(mesh.faces.ravel(), _angles(mesh).ravel(), minlength=count)
    # As many edges as faces around an inner vertex, one more on a rim: 2 pi and pi. The same count
    # keeps the sum right where two rims meet in a vertex or three triangles in an edge.
    deficit = np.where(faces_around > 0, np.pi * (2.0 + faces_around - edges_around) - angles, 0.0)
    on_rim = np.zeros(count, dtype=bool)
    on_rim[edges[times == 1]] = True
    return deficit, on_rim


def _angles(mesh: SurfaceMesh) -> _Angles:
    """Angles at the corners of each triangle, (m, 3), radians; they always sum to pi.

    Where corners coincide their angles are undefined and share equally what the others leave.
    """
    angles = igl.internal_angles(
        np.ascontiguousarray(mesh.vertices_mm, dtype=np.float64),
        np.ascontiguousarray(mesh.faces, dtype=np.int64),
    )
    undefined = np.isnan(angles)
    left = np.pi - np.nansum(angles, axis=1, keepdims=True)
    shared: _Angles = np.where(
        undefined, left / np.maximum(undefined.sum(axis=1, keepdims=True), 1), angles
    )
    return shared


def _signed_gradients_mm(mesh: SurfaceMesh, with_area: _TrianglesWithArea) -> Scalars:
    """Length of the derivative of the mesh's area by each vertex, mm; negative if it points inward.

    The derivative is half the cotangent sum of equation 8 of the paper, but stays bounded where
    a cotangent does not: at a corner it is half the opposite edge, turned upright in the triangle.
    """
    corners = mesh.triangles_mm
    opposite = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
    across = np.cross(opposite[:, 0], opposite[:, 1])
    outward = _gathered(mesh, np.repeat(across[:, None], 3, axis=1))
    # Without its triangle the ring around a vertex would not close, and a flat patch would bend.
    across[~with_area] = outward[mesh.faces[~with_area]].sum(axis=1)
    lengths = np.linalg.norm(across, axis=1, keepdims=True)
    normals = across / np.where(lengths > 0.0, lengths, 1.0)
    gradients = _gathered(mesh, np.cross(normals[:, None], opposite) / 2.0)
    signed: Scalars = np.copysign(
        np.linalg.norm(gradients, axis=1), np.einsum("nd,nd->n", gradients, outward)
    )
    return signed


def _gathered(mesh: SurfaceMesh, at_corners: np.ndarray) -> Points:
    """Vectors (m, 3, 3) given at the corners of each triangle, summed at each vertex, (n, 3)."""
    sums = np.zeros((len(mesh.vertices_mm), 3))
    np.add.at(sums, mesh.faces, at_corners)
    return sums
