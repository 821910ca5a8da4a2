"""Faulty triangles smoothed away: their vertices go where their neighbours are, and from there back
to the surface as far as no triangle becomes faulty again.
"""

import numpy as np
from jaxtyping import Bool
from scipy import sparse

from worker.arrays import Points
from worker.evaluation.surface_normals import vertex_normals
from worker.remeshing.edges import edges_of
from worker.surface_mesh import SurfaceMesh
from worker.tracking.faults import FaceFlags, against, folded, narrow, turned_over
from worker.tracking.frame_surface import FrameSurface

LEAST_ANGLE_DEG = 10.0
_FOLD_DEG = 140.0
"""Both no milder than what is counted as a fault afterwards."""

_NEEDLE_DEG = 3.0
"""A narrow triangle that smoothing does not widen may stay, but no narrower than this."""

_EVEN_ROUNDS = 40
"""From then on only what is broken counts: turned over, folded or a needle."""

_MOST_ROUNDS = 160
_WIDER_EVERY = 16
"""Rounds after which vertices one edge further out move too."""

_BACK_ROUNDS = 8
"""Of half the way each."""


VertexFlags = Bool[np.ndarray, " n"]
"""One truth value a vertex."""


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

    def untangled(
        self, mesh: SurfaceMesh, surface: FrameSurface, *, to_the_end: bool = False
    ) -> SurfaceMesh:
        """The mesh with as few faulty triangles as can be had: where its surface is thinner than
        its triangles some may be left, and they are counted among the measures.

        to_the_end: Where some are left, the mesh after all rounds, not the one with the fewest.
        """
        vertices = mesh.vertices_mm
        moved = np.zeros(len(vertices), dtype=bool)
        fewest, best, moved_then = len(mesh.faces) + 1, vertices, moved
        wrong = against(mesh, surface)
        for done in range(_MOST_ROUNDS):
            now = SurfaceMesh(vertices, mesh.faces)
            if done and done % _WIDER_EVERY == 0:
                wrong = against(now, surface)
            # What lies against the surface is smoothed for as long as until it is asked again.
            faulty = self._faulty(now) | wrong if done < _EVEN_ROUNDS else self.broken(now)
            if done >= _EVEN_ROUNDS and faulty.sum() < fewest:
                fewest, best, moved_then = faulty.sum(), vertices, moved.copy()
            if not faulty.any():
                break
            moving = self._around(mesh.faces[faulty].ravel(), done // _WIDER_EVERY)
            vertices = self._smoothed(vertices, moving)
            moved |= moving
        else:
            if to_the_end:
                return SurfaceMesh(vertices, mesh.faces)
            # Smoothing on and on takes whole ends away, and helps no more.
            vertices, moved = best, moved_then
        return self._drawn_back(SurfaceMesh(vertices, mesh.faces), moved, surface)

    def broken(self, mesh: SurfaceMesh) -> FaceFlags:
        """Triangles that are turned over, folded or needles."""
        return turned_over(mesh) | folded(mesh, self._edges, _FOLD_DEG) | narrow(mesh, _NEEDLE_DEG)

    def _drawn_back(
        self, mesh: SurfaceMesh, moved: VertexFlags, surface: FrameSurface
    ) -> SurfaceMesh:
        """The mesh with its `moved` vertices nearer to the surface again, and no more broken."""
        vertices, faces = mesh.vertices_mm, mesh.faces
        sound = ~self.broken(mesh)
        for _ in range(_BACK_ROUNDS if moved.any() else 0):
            now = SurfaceMesh(vertices, faces)
            places, _ = surface.matched(vertices[moved], vertex_normals(now)[moved])
            tried = vertices.copy()
            tried[moved] = 0.5 * (vertices[moved] + places)
            # Back to where they were, until what is left of the step is sound.
            while (broken := self.broken(SurfaceMesh(tried, faces)) & sound).any():
                corners = faces[broken].ravel()
                if np.array_equal(tried[corners], vertices[corners]):
                    corners = np.arange(len(vertices))
                tried[corners] = vertices[corners]
            vertices = tried
        return SurfaceMesh(vertices, faces)

    def _faulty(self, mesh: SurfaceMesh) -> FaceFlags:
        return (
            turned_over(mesh) | folded(mesh, self._edges, _FOLD_DEG) | narrow(mesh, LEAST_ANGLE_DEG)
        )

    def _around(self, touched: np.ndarray, rings: int) -> VertexFlags:
        """These vertices, and those that so many edges lead to from them."""
        found = np.zeros(len(self._degrees), dtype=bool)
        found[touched] = True
        for _ in range(rings):
            found |= self._neighbours @ found > 0.0
        return found

    def _smoothed(self, vertices: Points, moving: VertexFlags) -> Points:
        moved = vertices.copy()
        middles = (self._neighbours @ vertices) / self._degrees
        moved[moving] = 0.5 * (vertices[moving] + middles[moving])
        return moved
