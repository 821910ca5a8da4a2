"""The edges of any triangulation, each once, and how often its triangles run along it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from worker.evaluation.kept_by_mesh import KeptByMesh
from worker.surface_mesh import SurfaceMesh

Counts = Int[np.ndarray, " e"]
"""One number an edge."""

Edges = Int[np.ndarray, "e 2"]
"""Vertex indices of edges."""


@dataclass(frozen=True, eq=False)
class MeshEdges:
    """Every edge of a mesh, closed or not, with forks or without.

    ends: (e, 2), the smaller index first. times: of how many triangles' sides it is one. forward:
    how many of these run from the smaller index to the larger. sides: indices of all sides, 3 *
    face + corner, edge after edge; a side runs from that corner to the next one of the face.
    """

    ends: Edges
    times: Counts
    forward: Counts
    sides: Int[np.ndarray, " s"]


_EDGES: KeptByMesh[MeshEdges] = KeptByMesh()
"""Sorting takes most of the time of a question about a mesh's topology, and a report asks six."""


def mesh_edges(mesh: SurfaceMesh) -> MeshEdges:
    """The edges of a mesh, sorted by their ends."""
    return _EDGES.of(mesh, _found)


def _found(mesh: SurfaceMesh) -> MeshEdges:
    starts, ends = mesh.faces.ravel(), mesh.faces[:, [1, 2, 0]].ravel()
    # One number for each edge: numbers are sorted ten times as quickly as pairs.
    codes = np.minimum(starts, ends) * len(mesh.vertices_mm) + np.maximum(starts, ends)
    order = np.argsort(codes)
    codes = codes[order]
    first = np.flatnonzero(np.concatenate([[True], codes[1:] != codes[:-1]])[: len(codes)])
    forward = np.concatenate([[0], np.cumsum(starts[order] <= ends[order])])
    past = np.append(first, len(codes))
    sides = order[first]
    pairs = np.stack(
        [np.minimum(starts[sides], ends[sides]), np.maximum(starts[sides], ends[sides])]
    )
    return MeshEdges(pairs.T, np.diff(past), np.diff(forward[past]), order)
