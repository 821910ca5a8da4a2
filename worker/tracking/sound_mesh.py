"""A mesh fit to be carried: what is broken in it would stay so in every frame."""

import numpy as np

from worker.remeshing.edge_collapses import collapse_edges
from worker.remeshing.edges import edges_of
from worker.surface_mesh import SurfaceMesh
from worker.tracking.faults import FaceFlags
from worker.tracking.frame_surface import FrameSurface
from worker.tracking.untangling import Untangler

_MOST_ROUNDS = 20

_WIDEST = 3
"""Rings of triangles about the broken ones in which an edge is looked for that may go."""


def sound_mesh(mesh: SurfaceMesh) -> SurfaceMesh:
    """A closed mesh, mm, without its faults where that can be had: smoothed, and where smoothing
    does not help, as at a fin between a few vertices, with their edges drawn together.
    """
    surface = FrameSurface(mesh)
    for _ in range(_MOST_ROUNDS):
        untangler = Untangler(mesh)
        untangled = untangler.untangled(mesh, surface, to_the_end=True)
        broken = untangler.broken(untangled)
        if not broken.any():
            return untangled
        for _ in range(_WIDEST):
            fewer = _drawn_together(mesh, broken)
            if len(fewer.faces) < len(mesh.faces):
                break
            broken = np.asarray(np.isin(mesh.faces, mesh.faces[broken]).any(axis=1))
        else:
            return untangled
        mesh = fewer
    return Untangler(mesh).untangled(mesh, surface)


def _drawn_together(mesh: SurfaceMesh, at_fault: FaceFlags) -> SurfaceMesh:
    edges = edges_of(mesh.faces, len(mesh.vertices_mm))
    candidates = at_fault[edges.here // 3] | at_fault[edges.there // 3]
    return SurfaceMesh(*collapse_edges(mesh.vertices_mm, mesh.faces, candidates, may_fold=True))
