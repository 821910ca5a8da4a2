"""What the slices say away from the outlines: which places are inside, and which are not."""

import numpy as np
from scipy.spatial import cKDTree

from intake.even_odd import inside
from intake.planes import Plane
from schemas.vocabulary import Structure
from worker.arrays import Points, Scalars
from worker.interpolation.outline_points import evenly_along
from worker.reconstruction.slice_stack import Outline, SliceStack

_MARGIN_MM = 15.0
"""How far around the structure a slice is asked."""
_STEP_MM = 1.0


def known_sides(stack: SliceStack, structure: Structure, pitch_mm: float) -> tuple[Points, Scalars]:
    """Points (n, 3) mm on the slices, and (n,) the distance in mm to the structure's outlines.

    A square grid of `pitch_mm` on every slice that shows `structure` or says that it is absent.
    The distance is in the slice's plane, positive inside; on a slice without the structure it is
    minus that to the nearest outline on other slices. Both are no less than the true distance in
    space. Places nearest to the chord of an open outline are left out: nothing is known of them.
    """
    observed = np.concatenate(
        [o.points_mm for s in stack.slices for o in s.outlines.get(structure, ())]
    )
    everywhere = cKDTree(observed)
    points, signed = [], []
    for slice_ in stack.slices:
        outlines = slice_.outlines.get(structure, ())
        if not outlines and structure not in slice_.absent:
            continue
        plane = Plane.through(slice_.origin_mm, slice_.normal)
        grid = _grid(plane.to_plane(observed), pitch_mm)
        if outlines:
            grid, distance = _beside(grid, plane, outlines)
            points.append(plane.to_space(grid))
        else:
            points.append(plane.to_space(grid))
            distance = -everywhere.query(points[-1])[0]
        signed.append(distance)
    return np.concatenate(points), np.concatenate(signed)


def _grid(around: np.ndarray, pitch_mm: float) -> np.ndarray:
    low, high = around.min(axis=0) - _MARGIN_MM, around.max(axis=0) + _MARGIN_MM
    axes = [np.arange(a, b, pitch_mm) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)


def _beside(
    grid: np.ndarray, plane: Plane, outlines: tuple[Outline, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """The grid points that are nearer to an outline than to a chord, and their signed distance."""
    rings = [plane.to_plane(o.points_mm) for o in outlines]
    drawn = np.concatenate(
        [evenly_along(r, _STEP_MM, closed=o.closed) for r, o in zip(rings, outlines, strict=True)]
    )
    away, _ = cKDTree(drawn).query(grid)
    known = np.ones(len(grid), dtype=bool)
    for ring, outline in zip(rings, outlines, strict=True):
        if not outline.closed:
            chord = evenly_along(ring[[-1, 0]], _STEP_MM, closed=False)
            known &= cKDTree(chord).query(grid)[0] > away
    grid, away = grid[known], away[known]
    return grid, np.where(inside(grid, rings), away, -away)
