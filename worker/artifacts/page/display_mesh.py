"""A surface thinned out for the screen."""

from collections.abc import Mapping

import igl
import numpy as np
from scipy.spatial import cKDTree

from worker.arrays import SomeScalars
from worker.surface_mesh import SurfaceMesh

_MOST, _FEWEST, _OF_ALL_FRAMES = 7_000, 2_000, 28_000


def triangles_a_surface(frames: int) -> int:
    """How many triangles each surface has on a page of so many frames: over many frames fewer, for
    the page holds them all.
    """
    return min(_MOST, max(_FEWEST, _OF_ALL_FRAMES // max(1, frames)))


def display_mesh(
    mesh: SurfaceMesh, fields: Mapping[str, SomeScalars], triangles: int
) -> tuple[SurfaceMesh, dict[str, SomeScalars]]:
    """The mesh with about so many triangles, and its fields (vertices,), each value from the
    nearest vertex of before. A mesh that is no finer, or that cannot be thinned out, stays.
    """
    if len(mesh.faces) <= triangles:
        return mesh, dict(fields)
    vertices, faces, _, _ = igl.decimate(mesh.vertices_mm, mesh.faces, triangles)
    if not len(faces):  # edges of more than two triangles
        return mesh, dict(fields)
    thinned = SurfaceMesh(np.asarray(vertices), np.asarray(faces, dtype=np.int64))
    _, nearest = cKDTree(mesh.vertices_mm).query(thinned.vertices_mm)
    return thinned, {name: values[nearest] for name, values in fields.items()}
