"""A mesh fit to be carried: what is at fault in it would stay so in every frame."""

from dataclasses import dataclass

import numpy as np

from worker.observer import Cancelled, Observer, Unobserved
from worker.remeshing.edge_collapses import collapse_edges
from worker.remeshing.edges import edges_of
from worker.surface_mesh import SurfaceMesh
from worker.tracking.faults import at_fault, broken, turned_over
from worker.tracking.frame_surface import FrameSurface
from worker.tracking.patch import FaceFlags, Patch
from worker.tracking.untangling import untangled

_MOST_ROUNDS = 6

_WIDEST = 3
"""Rings of triangles about the faulty ones in which an edge is looked for that may go."""

_LEAST_COSINE = 0.2
"""Between a triangle's normal and one at its corners: one nearly turned over soon is."""


@dataclass(frozen=True, eq=False)
class SoundMesh:
    """A closed mesh, mm, and how many of its triangles are, or soon would be, at fault even so."""

    mesh: SurfaceMesh
    faults: int


def sound_mesh(mesh: SurfaceMesh, observer: Observer | None = None) -> SoundMesh:
    """A closed mesh, mm, without its faults where that can be had: smoothed, and where smoothing
    does not help, as at a fin between a few vertices, with their edges drawn together.

    Raises Cancelled when the observer asks to stop.
    """
    watcher = observer or Unobserved()
    surface = FrameSurface(mesh)
    found = []
    for _ in range(_MOST_ROUNDS):
        if watcher.is_cancelled():
            raise Cancelled
        whole = Patch.whole(mesh)
        smooth = untangled(mesh, surface, whole)
        faulty = at_fault(smooth, whole.pairs) | broken(smooth, whole.pairs)
        faulty |= turned_over(smooth, _LEAST_COSINE)
        found.append(SoundMesh(smooth, int(faulty.sum())))
        fewer = _drawn_together(mesh, faulty)
        if fewer is mesh:
            break
        mesh = fewer
    return min(found, key=lambda one: one.faults)


def _drawn_together(mesh: SurfaceMesh, faulty: FaceFlags) -> SurfaceMesh:
    """The mesh with some edges less about the faulty triangles; as it is where none may go."""
    edges = edges_of(mesh.faces, len(mesh.vertices_mm))
    for _ in range(_WIDEST if faulty.any() else 0):
        candidates = faulty[edges.here // 3] | faulty[edges.there // 3]
        vertices, faces = collapse_edges(mesh.vertices_mm, mesh.faces, candidates, may_fold=True)
        if len(faces) < len(mesh.faces):
            return SurfaceMesh(vertices, faces)
        faulty = np.asarray(np.isin(mesh.faces, mesh.faces[faulty]).any(axis=1))
    return mesh
