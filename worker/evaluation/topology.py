"""Whether a mesh is a closed, outward surface, and of which kind."""

import igl
import numpy as np
from jaxtyping import Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from worker.evaluation.size import signed_volume_ml
from worker.surface_mesh import SurfaceMesh

Edges = Int[np.ndarray, "e 2"]
"""Vertex indices of edges."""


def is_watertight(mesh: SurfaceMesh) -> bool:
    """Every edge belongs to exactly two triangles, which run along it in opposite directions.

    So the surface is closed, without forks, and consistently oriented.
    """
    if not len(mesh.faces):
        return False
    directed = _directed_edges(mesh)
    there = np.sort(_codes(directed, mesh))
    back = np.sort(_codes(directed[:, ::-1], mesh))
    return bool(np.all(there[1:] != there[:-1]) and np.array_equal(there, back))


def is_manifold(mesh: SurfaceMesh) -> bool:
    """No edge belongs to more than two triangles, and those about a vertex form one fan: a surface
    without forks, that touches itself nowhere. It may have rims.
    """
    faces = np.ascontiguousarray(mesh.faces, dtype=np.int64)
    if not len(faces):
        return False
    # libigl calls a vertex that no triangle uses non-manifold.
    compact = np.unique(faces, return_inverse=True)[1].reshape(faces.shape)
    return bool(igl.is_edge_manifold(compact)[0] and np.all(igl.is_vertex_manifold(compact)))


def is_outward(mesh: SurfaceMesh) -> bool:
    """Watertight, and its triangles counter-clockwise seen from outside: its volume is positive."""
    return is_watertight(mesh) and signed_volume_ml(mesh) > 0.0


def euler_number(mesh: SurfaceMesh) -> int:
    """Vertices - edges + faces, counting only vertices in use: 2 for a sphere, 0 for a torus."""
    return int(
        len(np.unique(mesh.faces))
        - len(np.unique(_codes(_undirected_edges(mesh), mesh)))
        + len(mesh.faces)
    )


def component_count(mesh: SurfaceMesh) -> int:
    """Number of pieces that share no vertex."""
    return _pieces(_undirected_edges(mesh))


def boundary_loop_count(mesh: SurfaceMesh) -> int:
    """Number of rims: connected sets of edges that belong to one triangle only."""
    edges = _undirected_edges(mesh)
    _, first, times = np.unique(_codes(edges, mesh), return_index=True, return_counts=True)
    return _pieces(edges[first[times == 1]])


def _directed_edges(mesh: SurfaceMesh) -> Edges:
    return mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)


def _codes(edges: Edges, mesh: SurfaceMesh) -> Int[np.ndarray, " e"]:
    """One number for each edge: numbers are sorted ten times as quickly as pairs."""
    return edges[:, 0] * len(mesh.vertices_mm) + edges[:, 1]


def _undirected_edges(mesh: SurfaceMesh) -> Edges:
    return np.sort(_directed_edges(mesh), axis=1)


def _pieces(edges: Edges) -> int:
    """Connected components of the graph with these edges, and the vertices they touch."""
    if not len(edges):
        return 0
    touched, index = np.unique(edges, return_inverse=True)
    start, end = index.reshape(-1, 2).T
    size = len(touched)
    graph = coo_array((np.ones(len(start)), (start, end)), shape=(size, size))
    return int(connected_components(graph, directed=False)[0])
