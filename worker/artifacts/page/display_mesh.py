"""A surface thinned out for the screen."""

from collections.abc import Mapping

import fast_simplification
import numpy as np
from scipy.spatial import cKDTree

from worker.arrays import SomeScalars
from worker.evaluation.topology import is_watertight
from worker.surface_mesh import SurfaceMesh

MOST_TRIANGLES = 7_000
"""Of a surface that is one frame's alone, in any file for viewers."""

_FEWEST, _OF_ALL_FRAMES = 2_000, 28_000

_STEPS = (2.25, 1.5, 1.0)


def triangles_a_surface(frames: int) -> int:
    """How many triangles each surface has on a page of so many frames: over many frames fewer, for
    the page holds them all.
    """
    return min(MOST_TRIANGLES, max(_FEWEST, _OF_ALL_FRAMES // max(1, frames)))


def display_mesh(mesh: SurfaceMesh, triangles: int) -> SurfaceMesh:
    """The mesh with about so many triangles. A mesh that is no finer stays, and a closed one is
    closed afterwards, if need be with half as many triangles more.

    Quadrics, in steps: each counts the error anew, from the mesh of the step before. At 2000
    triangles a heart is kept within 0.25 mm, in one step within 0.41 mm; collapsing the shortest
    edges to their middles cuts up to 2 mm off its ends. One thread at a time: the library has its
    mesh in globals.
    """
    closed = is_watertight(mesh)
    thinned = mesh
    for times_as_many in _STEPS:
        count = int(times_as_many * triangles)
        if count >= len(thinned.faces):
            continue
        vertices, faces = fast_simplification.simplify(
            thinned.vertices_mm, thinned.faces.astype(np.int32), target_count=count
        )
        thinner = SurfaceMesh(vertices, faces.astype(np.int64))
        # One surface in fifty folds at an edge, which four triangles share from then on.
        if not closed or is_watertight(thinner):
            thinned = thinner
    return thinned


def fields_at(
    thinned: SurfaceMesh, mesh: SurfaceMesh, fields: Mapping[str, SomeScalars]
) -> dict[str, SomeScalars]:
    """Fields of a mesh (vertices,) at the vertices of what is left of it: each value from the
    nearest vertex of before.
    """
    if thinned is mesh or not fields:
        return dict(fields)
    _, nearest = cKDTree(mesh.vertices_mm).query(thinned.vertices_mm)
    return {name: values[nearest] for name, values in fields.items()}
