"""Faulty triangles smoothed away: their vertices go where their neighbours are."""

import numpy as np
from scipy import sparse

from worker.arrays import Points
from worker.remeshing.edges import edges_of
from worker.surface_mesh import SurfaceMesh
from worker.tracking.faults import FaceFlags, against, folded, narrow, turned_over
from worker.tracking.frame_surface import FrameSurface

LEAST_ANGLE_DEG = 10.0
_FOLD_DEG = 140.0
"""Both no milder than what is counted as a fault afterwards."""

_MOST_ROUNDS = 40
_WIDER_EVERY = 8
"""Rounds after which vertices one edge further out move too."""


class Untangler:
    """The neighbourhoods of a closed mesh. Raises ValueError for one that is not closed."""

    def __init__(self, rest: SurfaceMesh) -> None:
        self._edges = edges_of(rest.faces, len(rest.vertices_mm))
        count = len(rest.vertices_mm)
        start, end = self._edges.start, self._edges.end
        ones = np.ones(2 * len(start))
        ends = (np.concatenate([start, end]), np.concatenate([end, start]))
        self._neighbours = sparse.csr_matrix((ones, ends), shape=(count, count))
        self._degrees = np.asarray(self._neighbours.sum(axis=1))

    def untangled(self, mesh: SurfaceMesh, surface: FrameSurface) -> SurfaceMesh:
        """The mesh with as few faulty triangles as can be had: where its surface is thinner than
        its triangles some may be left, and they are counted among the measures.
        """
        vertices = mesh.vertices_mm
        wrong = against(mesh, surface)
        for done in range(_MOST_ROUNDS):
            now = SurfaceMesh(vertices, mesh.faces)
            if done and done % _WIDER_EVERY == 0:
                wrong = against(now, surface)
            # What lies against the surface is smoothed for as long as until it is asked again.
            faulty = self._faulty(now) | wrong
            if not faulty.any():
                break
            vertices = self._smoothed(vertices, mesh.faces[faulty].ravel(), done // _WIDER_EVERY)
        return SurfaceMesh(vertices, mesh.faces)

    def _faulty(self, mesh: SurfaceMesh) -> FaceFlags:
        return (
            turned_over(mesh) | folded(mesh, self._edges, _FOLD_DEG) | narrow(mesh, LEAST_ANGLE_DEG)
        )

    def _smoothed(self, vertices: Points, touched: np.ndarray, rings: int) -> Points:
        moving = np.zeros(len(vertices), dtype=bool)
        moving[touched] = True
        for _ in range(rings):
            moving |= self._neighbours @ moving > 0.0
        moved = vertices.copy()
        middles = (self._neighbours @ vertices) / self._degrees
        moved[moving] = 0.5 * (vertices[moving] + middles[moving])
        return moved
