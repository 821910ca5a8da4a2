"""Triangles that a carried mesh should not have: turned over, folded onto a neighbour, passing
through another, or needles.
"""

import numpy as np

from worker.arrays import Faces, Points, SomePoints
from worker.evaluation.surface_normals import unit, vertex_normals
from worker.evaluation.triangle_crossings import self_intersections
from worker.surface_mesh import SurfaceMesh
from worker.tracking.frame_surface import FrameSurface
from worker.tracking.patch import FaceFlags, FacePairs

FOLD_DEGREES = 150.0
"""Angle between the normals of two neighbours, above which they are folded onto each other."""

_SHARP_DEGREES = 140.0
"""Angle above which they are smoothed: milder, so that none comes near to being a fault."""

NEEDLE_DEGREES = 3.0
"""A narrow triangle that smoothing does not widen is let be from here on."""


def face_normals(vertices_mm: Points, faces: Faces) -> SomePoints:
    """Unit normals of the triangles, zero for one without area."""
    a, b, c = (vertices_mm[faces[:, corner]] for corner in range(3))
    return unit(np.cross(b - a, c - a))


def turned_over(mesh: SurfaceMesh, least_cosine: float = 0.0) -> FaceFlags:
    """Triangles against the mesh's own normals at each of their corners."""
    normals = face_normals(mesh.vertices_mm, mesh.faces)
    cosines = np.einsum("mkd,md->mk", vertex_normals(mesh)[mesh.faces], normals)
    return (cosines < least_cosine).all(axis=1)


def against(mesh: SurfaceMesh, surface: FrameSurface) -> FaceFlags:
    """Triangles against the normals of `surface` where it is nearest, to their middle and to each
    of their corners. On an end thinner than its triangles that may be the other side.
    """
    normals = face_normals(mesh.vertices_mm, mesh.faces)
    _, facing = surface.nearest(mesh.triangles_mm.mean(axis=1))
    found = np.einsum("md,md->m", facing, normals) < 0.0
    asked = np.flatnonzero(found)
    if len(asked):
        _, facing = surface.nearest(mesh.triangles_mm[asked].reshape(-1, 3))
        cosines = np.einsum("mkd,md->mk", facing.reshape(-1, 3, 3), normals[asked])
        found[asked] = (cosines < 0.0).all(axis=1)
    return found


def folded(mesh: SurfaceMesh, pairs: FacePairs, degrees: float = FOLD_DEGREES) -> FaceFlags:
    """Triangles whose normal turns by more than `degrees` across one of their edges. pairs: the two
    triangles at each edge.
    """
    normals = face_normals(mesh.vertices_mm, mesh.faces)
    here, there = pairs.T
    sharp = np.einsum("ed,ed->e", normals[here], normals[there]) < np.cos(np.radians(degrees))
    found = np.zeros(len(mesh.faces), dtype=bool)
    found[pairs[sharp].ravel()] = True
    return found


def narrow(mesh: SurfaceMesh, degrees: float) -> FaceFlags:
    """Triangles with an angle under `degrees`."""
    sides = mesh.triangles_mm - np.roll(mesh.triangles_mm, 1, axis=1)
    lengths = np.sort(np.linalg.norm(sides, axis=2), axis=1)
    doubled = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return doubled < np.sin(np.radians(degrees)) * lengths[:, 1] * lengths[:, 2]


def broken(mesh: SurfaceMesh, pairs: FacePairs, least_degrees: float = NEEDLE_DEGREES) -> FaceFlags:
    """Triangles that are turned over, nearly folded, or have an angle under `least_degrees`."""
    sharp = folded(mesh, pairs, _SHARP_DEGREES)
    return turned_over(mesh) | sharp | narrow(mesh, least_degrees)


def at_fault(mesh: SurfaceMesh, pairs: FacePairs) -> FaceFlags:
    """Triangles that are turned over, folded or pass through others: what is counted."""
    found = turned_over(mesh) | folded(mesh, pairs)
    found[self_intersections(mesh).ravel()] = True
    return found
