"""Shape-based interpolation, the classical baseline: in-plane signed distances, blended linearly.

Raya and Udupa, IEEE TMI 9(1), 1990. Short-axis slices only, which is all it can use.
"""

import numpy as np
from scipy.spatial import cKDTree

from intake.even_odd import inside
from intake.planes import Plane
from schemas.vocabulary import Structure, View
from worker.reconstruction.component import outward, touched_component
from worker.reconstruction.isosurface import isosurfaces
from worker.reconstruction.slice_stack import SliceStack
from worker.surface_mesh import SurfaceMesh


def shape_based(stack: SliceStack, structure: Structure, cell_mm: float = 1.25) -> SurfaceMesh:
    """The surface of `structure`, closed half a slice gap beyond its first and last slice."""
    showing = [s for s in stack.slices if s.view is View.SAX and structure in s.outlines]
    base = Plane.through(showing[0].origin_mm, showing[0].normal)
    heights = np.array([(s.origin_mm - base.origin) @ base.normal for s in showing])
    order = np.argsort(heights)
    heights = heights[order]
    rings = [[base.to_plane(o.points_mm) for o in showing[i].outlines[structure]] for i in order]
    trees = [cKDTree(np.concatenate([_dense(ring) for ring in found])) for found in rings]

    def signed_mm(slice_index: int, in_plane: np.ndarray) -> np.ndarray:
        away, _ = trees[slice_index].query(in_plane)
        return np.where(inside(in_plane, rings[slice_index]), away, -away)

    def distances(points: np.ndarray) -> np.ndarray:
        in_plane, z = points[:, :2], points[:, 2]
        upper = np.clip(np.searchsorted(heights, z), 1, len(heights) - 1)
        t = np.clip((z - heights[upper - 1]) / (heights[upper] - heights[upper - 1]), 0.0, 1.0)
        blended = np.empty(len(points))
        for k in range(1, len(heights)):
            own = upper == k
            below, above = signed_mm(k - 1, in_plane[own]), signed_mm(k, in_plane[own])
            blended[own] = (1.0 - t[own]) * below + t[own] * above
        # Beyond the ends the outline shrinks as fast as it is left behind.
        beyond = np.maximum(heights[0] - z, 0.0) + np.maximum(z - heights[-1], 0.0)
        half_gap = 0.5 * float(np.median(np.diff(heights)))
        return np.where(beyond > half_gap, -beyond, blended - beyond)[:, None]

    everything = np.concatenate([ring for found in rings for ring in found])
    margin = 4.0 * cell_mm
    gap = float(np.median(np.diff(heights)))
    lower = np.array([*everything.min(axis=0), heights[0] - gap]) - margin
    upper = np.array([*everything.max(axis=0), heights[-1] + gap]) + margin
    (found,) = isosurfaces(distances, lower, upper, cell_mm)
    middle = len(rings) // 2
    in_plane = np.concatenate(rings[middle])
    touching = np.column_stack([in_plane, np.full(len(in_plane), heights[middle])])
    vertices, faces = touched_component(found.vertices, found.faces, touching)
    in_space = base.to_space(vertices[:, :2]) + vertices[:, 2:] * base.normal
    return SurfaceMesh(in_space, outward(in_space, faces))


def _dense(ring: np.ndarray) -> np.ndarray:
    ends = np.roll(ring, -1, axis=0)
    t = np.linspace(0.0, 1.0, 8, endpoint=False)[:, None, None]
    return (ring + t * (ends - ring)).reshape(-1, 2)
