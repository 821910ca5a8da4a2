"""The nearest points of a surface, and which of them are where the surface merely ends."""

import igl
import numpy as np
from jaxtyping import Bool, Int

from worker.arrays import Flags, Points
from worker.evaluation.distance import nearest_on_surface
from worker.evaluation.surface_normals import unit
from worker.surface_mesh import SurfaceMesh

_NO_WEIGHT = 1e-9
"""Barycentric weight of a corner below which a point is on the edge opposite to it."""


class NearestOffRim:
    """Nearest points of one mesh, its rims found once."""

    def __init__(self, mesh: SurfaceMesh) -> None:
        self._mesh = mesh
        corners = mesh.triangles_mm
        self._normals = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
        self._opposite_is_rim = _opposite_is_rim(mesh)
        rims = mesh.faces[:, [[1, 2], [2, 0], [0, 1]]][self._opposite_is_rim]
        self._corner_on_rim = np.isin(mesh.faces, rims)

    def __call__(self, points_mm: Points) -> tuple[Points, Points, Flags]:
        """Of each of (n, 3) points: the nearest point of the mesh (n, 3) mm, the unit normal of its
        triangle (n, 3), and whether it is off the rims, (n,).
        """
        places, faces = nearest_on_surface(points_mm, self._mesh)
        off_rim = np.ones(len(faces), dtype=bool)
        near = np.flatnonzero(self._corner_on_rim[faces].any(axis=1))
        if len(near):
            off_rim[near] = ~self._on_rim(places[near], faces[near])
        return places, self._normals[faces], off_rim

    def _on_rim(self, places_mm: Points, faces: Int[np.ndarray, " n"]) -> Flags:
        """On an edge, or at a corner whose triangle here may be one without such an edge."""
        corners = self._mesh.triangles_mm[faces]
        a, b, c = (np.ascontiguousarray(corners[:, corner]) for corner in range(3))
        weights = igl.barycentric_coordinates(np.ascontiguousarray(places_mm), a, b, c)
        on_edge = (weights < _NO_WEIGHT) & self._opposite_is_rim[faces]
        at_corner = (weights > 1.0 - _NO_WEIGHT) & self._corner_on_rim[faces]
        on_rim: Flags = (on_edge | at_corner).any(axis=1)
        return on_rim


def _opposite_is_rim(mesh: SurfaceMesh) -> Bool[np.ndarray, "m 3"]:
    """Whether the edge opposite to each corner belongs to one triangle only."""
    sides = np.sort(mesh.faces[:, [1, 2, 2, 0, 0, 1]].reshape(-1, 2), axis=1)
    codes = sides[:, 0] * len(mesh.vertices_mm) + sides[:, 1]
    _, index, times = np.unique(codes, return_inverse=True, return_counts=True)
    rims: np.ndarray = (times[index] == 1).reshape(-1, 3)
    return rims
