"""Faulty triangles smoothed away: their vertices go where their neighbours are, and from there back
to the surface as far as no triangle becomes faulty again.
"""

from dataclasses import dataclass

import numpy as np

from worker.evaluation.surface_normals import vertex_normals
from worker.surface_mesh import SurfaceMesh
from worker.tracking.faults import NEEDLE_DEGREES, against, broken, narrow
from worker.tracking.frame_surface import FrameSurface
from worker.tracking.patch import FaceFlags, Patch

LEAST_ANGLE_DEG = 10.0
"""Triangles with a narrower angle are widened, where smoothing does that."""

_EVEN_RINGS = range(3)
_MEND_RINGS = range(3, 10)
"""About the faulty triangles; the vertices there move with them, with ever more rings."""

_ROUNDS = 16
"""With each number of rings."""

_MARGIN = 3
"""Rings about those that move, to where the patch ends that is worked on."""

_BACK_ROUNDS = 8
"""Of half the way each."""


def untangled(mesh: SurfaceMesh, surface: FrameSurface, whole: Patch) -> SurfaceMesh:
    """The mesh with as few broken triangles as smoothing leaves.

    surface: what it is to lie on. whole: all of the mesh.
    """
    # On the surface again, much of what smoothing folded comes apart.
    even = _drawn_back(_evened(mesh, surface, whole), mesh, surface, whole)
    if not broken(even, whole.pairs).any():
        return even
    return _drawn_back(_mended(even, whole), mesh, surface, whole)


@dataclass(frozen=True, eq=False)
class _State:
    """A mesh after a round, and how many of its triangles are broken."""

    mesh: SurfaceMesh
    broken: int


def _evened(mesh: SurfaceMesh, surface: FrameSurface, whole: Patch) -> SurfaceMesh:
    """Smoothed where triangles are broken, narrow or against the surface."""
    now = mesh
    for rings in _EVEN_RINGS:
        # What lies against the surface is smoothed for as long as until it is asked again.
        before = now
        now = _smoothed(now, whole, rings, LEAST_ANGLE_DEG, against(now, surface))[-1].mesh
        if now is before:
            break
    return now


def _mended(mesh: SurfaceMesh, whole: Patch) -> SurfaceMesh:
    """Smoothed where triangles are broken, for as long as that helps: on and on it would take whole
    ends away.
    """
    states = [_State(mesh, int(broken(mesh, whole.pairs).sum()))]
    none = np.zeros(len(mesh.faces), dtype=bool)
    for rings in _MEND_RINGS:
        states += _smoothed(states[-1].mesh, whole, rings, NEEDLE_DEGREES, none)
    return min(states, key=lambda state: state.broken).mesh


def _smoothed(
    mesh: SurfaceMesh, whole: Patch, rings: int, least_degrees: float, thin: FaceFlags
) -> list[_State]:
    """Before and after each round of smoothing about the triangles that are broken, under
    `least_degrees` or `thin`, until there are none.
    """
    faulty = broken(mesh, whole.pairs, least_degrees) | thin
    if not faulty.any():
        return [_State(mesh, 0)]
    patch = whole.cut(whole.around(mesh.faces[faulty].ravel(), rings + _MARGIN))
    now, thin = patch.of(mesh), thin[patch.triangles]
    states: list[_State] = []
    while True:
        worst = broken(now, patch.pairs) & patch.judged
        states.append(_State(patch.put(mesh, now), int(worst.sum())))
        faulty = worst | ((narrow(now, least_degrees) | thin) & patch.judged)
        if len(states) > _ROUNDS or not faulty.any():
            return states
        moving = patch.around(now.faces[faulty].ravel(), rings) & patch.free
        vertices = now.vertices_mm.copy()
        middles = (patch.neighbours @ vertices) / patch.degrees[:, None]
        vertices[moving] = 0.5 * (vertices[moving] + middles[moving])
        now = SurfaceMesh(vertices, patch.faces)


def _drawn_back(
    mesh: SurfaceMesh, before: SurfaceMesh, surface: FrameSurface, whole: Patch
) -> SurfaceMesh:
    """The mesh, where it is not as `before`, nearer to the surface again, and no more broken."""
    changed = (mesh.vertices_mm != before.vertices_mm).any(axis=1)
    if not changed.any():
        return mesh
    patch = whole.cut(whole.around(changed, _MARGIN))
    now, moved = patch.of(mesh), changed[patch.vertices]
    may_break = broken(now, patch.pairs) | ~patch.judged
    for _ in range(_BACK_ROUNDS):
        vertices = now.vertices_mm
        places, _ = surface.matched(vertices[moved], vertex_normals(now)[moved])
        tried = vertices.copy()
        tried[moved] = 0.5 * (vertices[moved] + places)
        now = SurfaceMesh(tried, patch.faces)
        # Back to where they were, until what is left of the step is sound.
        while (faulty := broken(now, patch.pairs) & ~may_break).any():
            corners = patch.faces[faulty].ravel()
            if np.array_equal(tried[corners], vertices[corners]):
                corners = np.arange(len(vertices))
            tried[corners] = vertices[corners]
    return patch.put(mesh, now)
