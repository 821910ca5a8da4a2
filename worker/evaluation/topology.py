"""Whether a mesh is a closed, outward surface, and of which kind."""

import numpy as np
from jaxtyping import Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from worker.evaluation.mesh_edges import Edges, mesh_edges
from worker.evaluation.size import signed_volume_ml
from worker.surface_mesh import SurfaceMesh


def is_watertight(mesh: SurfaceMesh) -> bool:
    """Every edge belongs to exactly two triangles, which run along it in opposite directions.

    So the surface is closed, without forks, and consistently oriented.
    """
    edges = mesh_edges(mesh)
    return bool(len(mesh.faces) and np.all(edges.times == 2) and np.all(edges.forward == 1))


def is_manifold(mesh: SurfaceMesh) -> bool:
    """No edge belongs to more than two triangles, and those about a vertex form one fan: a surface
    without forks, that touches itself nowhere. It may have rims.
    """
    if not len(mesh.faces) or np.any(mesh_edges(mesh).times > 2):
        return False
    return _fan_count(mesh) == len(np.unique(mesh.faces))


def is_outward(mesh: SurfaceMesh) -> bool:
    """Watertight, and its triangles counter-clockwise seen from outside: its volume is positive."""
    return is_watertight(mesh) and signed_volume_ml(mesh) > 0.0


def euler_number(mesh: SurfaceMesh) -> int:
    """Vertices - edges + faces, counting only vertices in use: 2 for a sphere, 0 for a torus."""
    return int(len(np.unique(mesh.faces)) - len(mesh_edges(mesh).ends) + len(mesh.faces))


def component_count(mesh: SurfaceMesh) -> int:
    """Number of pieces that share no vertex."""
    return _pieces(mesh_edges(mesh).ends)


def boundary_loop_count(mesh: SurfaceMesh) -> int:
    """Number of rims: connected sets of edges that belong to one triangle only."""
    edges = mesh_edges(mesh)
    return _pieces(edges.ends[edges.times == 1])


def _fan_count(mesh: SurfaceMesh) -> int:
    """Sets of triangles' corners that are neighbours about a vertex, of a mesh without forks."""
    edges = mesh_edges(mesh)
    last = np.cumsum(edges.times)[edges.times == 2] - 1
    here, there = edges.sides[last - 1], edges.sides[last]
    corners = mesh.faces.ravel()
    # The corners that a side runs between; a neighbour's runs the same way where it is turned over.
    starts, ends = _corners_of(here)
    others, other_ends = _corners_of(there)
    alike = corners[starts] == corners[others]
    others, other_ends = np.where(alike, others, other_ends), np.where(alike, other_ends, others)
    return _set_count(
        np.concatenate([starts, ends]), np.concatenate([others, other_ends]), len(corners)
    )


def _corners_of(sides: Int[np.ndarray, " k"]) -> tuple[np.ndarray, np.ndarray]:
    return sides, np.where(sides % 3 == 2, sides - 2, sides + 1)


def _pieces(edges: Edges) -> int:
    """Connected components of the graph with these edges, and the vertices they touch."""
    if not len(edges):
        return 0
    touched = np.zeros(int(edges.max()) + 1, dtype=bool)
    touched[edges.ravel()] = True
    start, end = edges.T
    return _set_count(start, end, len(touched)) - int(np.count_nonzero(~touched))


def _set_count(start: np.ndarray, end: np.ndarray, size: int) -> int:
    """Connected components of so many nodes, joined from each start to its end."""
    graph = coo_array((np.ones(len(start)), (start, end)), shape=(size, size))
    return int(connected_components(graph, directed=False)[0])
