"""Part of a closed triangulation, cut out so that work on a few triangles costs no more than these.

Vertices and triangles of a patch are numbered anew. On its rim triangles are missing, so it says
which triangles can be judged there, and which vertices may move without harm to one that cannot.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Int
from scipy import sparse

from worker.arrays import Flags
from worker.remeshing.edges import edges_of
from worker.surface_mesh import SurfaceMesh

FaceFlags = Bool[np.ndarray, " m"]
"""One truth value a triangle."""

FacePairs = Int[np.ndarray, "e 2"]
"""Two triangles at each edge."""


@dataclass(frozen=True, eq=False)
class Patch:
    """Some of a mesh's triangles, and their vertices.

    vertices, triangles: their numbers in the whole mesh, (n,) and (m,). faces: (m, 3), of the
    patch's own numbers. pairs: triangles that share an edge. neighbours: (n, n), one where an edge
    is. judged: triangles whose corners have all of their triangles here. free: vertices of which
    every triangle is judged.
    """

    vertices: Int[np.ndarray, " n"]
    triangles: Int[np.ndarray, " m"]
    faces: Int[np.ndarray, "m 3"]
    pairs: FacePairs
    neighbours: sparse.csr_matrix
    judged: FaceFlags
    free: Flags

    @cached_property
    def degrees(self) -> Int[np.ndarray, " n"]:
        """Edges that end at each vertex."""
        return np.diff(self.neighbours.indptr)

    @classmethod
    def whole(cls, mesh: SurfaceMesh) -> "Patch":
        """All of a mesh. Raises ValueError for one that is not closed."""
        count = len(mesh.vertices_mm)
        edges = edges_of(mesh.faces, count)
        return cls(
            vertices=np.arange(count),
            triangles=np.arange(len(mesh.faces)),
            faces=mesh.faces,
            pairs=np.stack([edges.here // 3, edges.there // 3], axis=1),
            neighbours=_neighbours(edges.start, edges.end, count),
            judged=np.ones(len(mesh.faces), dtype=bool),
            free=np.ones(count, dtype=bool),
        )

    def around(self, vertices: np.ndarray, rings: int) -> Flags:
        """These vertices, flags or numbers, and those that so many edges lead to from them."""
        found = np.zeros(len(self.vertices), dtype=bool)
        found[vertices] = True
        for _ in range(rings):
            found |= self.neighbours @ found > 0.0
        return found

    def cut(self, inside: Flags) -> "Patch":
        """Of a whole mesh, all triangles that touch the vertices `inside`."""
        touched = inside[self.faces]
        kept = touched.any(axis=1)
        vertices = np.unique(self.faces[kept])
        renumbered, renamed = np.cumsum(kept) - 1, np.full(len(self.vertices), -1)
        renamed[vertices] = np.arange(len(vertices))
        faces = renamed[self.faces[kept]]
        judged = touched[kept].all(axis=1)
        free = np.ones(len(vertices), dtype=bool)
        free[faces[~judged].ravel()] = False
        return Patch(
            vertices=vertices,
            triangles=np.flatnonzero(kept),
            faces=faces,
            pairs=renumbered[self.pairs[kept[self.pairs].all(axis=1)]],
            neighbours=self.neighbours[vertices][:, vertices],
            judged=judged,
            free=free,
        )

    def of(self, mesh: SurfaceMesh) -> SurfaceMesh:
        """This part of the whole mesh."""
        return SurfaceMesh(mesh.vertices_mm[self.vertices], self.faces)

    def put(self, mesh: SurfaceMesh, part: SurfaceMesh) -> SurfaceMesh:
        """The whole mesh with this part of it replaced."""
        vertices = mesh.vertices_mm.copy()
        vertices[self.vertices] = part.vertices_mm
        return SurfaceMesh(vertices, mesh.faces)


def _neighbours(start: np.ndarray, end: np.ndarray, count: int) -> sparse.csr_matrix:
    ends = (np.concatenate([start, end]), np.concatenate([end, start]))
    return sparse.csr_matrix((np.ones(2 * len(start)), ends), shape=(count, count))
