"""A mesh brought nearest to a surface by an affine map."""

import numpy as np

from worker.arrays import Points
from worker.evaluation.surface_normals import vertex_normals
from worker.surface_mesh import SurfaceMesh
from worker.tracking.frame_surface import FrameSurface

_ROUNDS = 8

_STIFFNESS = 0.02
"""Weight of the map's difference from none, beside the distances along normals: a solid of
revolution would be turned, and a ball stretched, at will."""

_MOST_POINTS = 1500


def affine_copy(rest: SurfaceMesh, start_mm: Points, surface: FrameSurface) -> Points:
    """The vertices (n, 3) of `rest` mapped to XA + t, of least mean squared distance along the
    surface's normals (Chen and Medioni 1992, affine). Matches are first sought from `start_mm`.
    """
    every = max(1, len(rest.vertices_mm) // _MOST_POINTS)
    middle = rest.vertices_mm.mean(axis=0)
    size = np.sqrt(((rest.vertices_mm - middle) ** 2).sum(axis=1).mean())
    points = (rest.vertices_mm[::every] - middle) / size
    normals = vertex_normals(SurfaceMesh(start_mm, rest.faces))[::every]
    none = np.vstack([size * np.eye(3), start_mm.mean(axis=0)[None]])
    with_one = np.column_stack([points, np.ones(len(points))])
    held = np.diag(np.repeat([_STIFFNESS, _STIFFNESS, _STIFFNESS, 0.0], 3)) * len(points)
    where, found = start_mm[::every], none
    for _ in range(_ROUNDS):
        places, facing = surface.matched(where, normals)
        agreeing = np.clip(np.einsum("nd,nd->n", facing, normals), 0.0, 1.0)[:, None]
        rows = (with_one[:, :, None] * facing[:, None, :]).reshape(len(points), 12)
        heights = np.einsum("nd,nd->n", places, facing)
        left = (agreeing * rows).T @ rows + held
        right = (agreeing * rows).T @ heights + held @ none.ravel()
        found = np.linalg.solve(left, right).reshape(4, 3)
        where = with_one @ found
    everywhere = np.column_stack([(rest.vertices_mm - middle) / size, np.ones(len(start_mm))])
    copy: np.ndarray = everywhere @ found
    return copy
