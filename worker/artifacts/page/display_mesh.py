"""A surface thinned out for the screen."""

from collections.abc import Mapping

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
    nearest vertex of before. A mesh that is no finer stays.
    """
    if len(mesh.faces) <= triangles:
        return mesh, dict(fields)
    # Here, since VTK takes half a second to load. Its quadrics keep 2000 triangles within 0.2 mm of
    # a heart; collapsing the shortest edges to their middles cuts up to 2 mm off its ends.
    import pyvista

    whole = pyvista.PolyData.from_regular_faces(mesh.vertices_mm, mesh.faces)
    thin = whole.decimate(1.0 - triangles / len(mesh.faces))
    thinned = SurfaceMesh(
        np.asarray(thin.points, dtype=np.float64), np.asarray(thin.regular_faces, dtype=np.int64)
    )
    _, nearest = cKDTree(mesh.vertices_mm).query(thinned.vertices_mm)
    return thinned, {name: values[nearest] for name, values in fields.items()}
