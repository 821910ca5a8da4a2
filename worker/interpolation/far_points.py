"""Points around a structure that are outside whatever its slices show."""

import numpy as np
from scipy.spatial import ConvexHull, cKDTree

from worker.arrays import Points, Scalars, SomePoints


def far_points(points_mm: SomePoints, away_mm: float, count: int) -> tuple[Points, Scalars]:
    """`count` points `away_mm` beyond the convex hull of (k, 3) points, seen from its centroid.

    Returns (count, 3), and (count,) minus their distance to the nearest of the points: at most that
    is the surface away. Evenly spread directions: a Fibonacci lattice on the sphere.
    """
    centre = points_mm.mean(axis=0)
    facets = ConvexHull(points_mm).equations
    index = np.arange(count) + 0.5
    turn, height = np.pi * (1.0 + np.sqrt(5.0)) * index, 1.0 - 2.0 * index / count
    level = np.sqrt(1.0 - height**2)
    directions = np.column_stack([level * np.cos(turn), level * np.sin(turn), height])
    steep = directions @ facets[:, :3].T
    depth = -(facets[:, :3] @ centre + facets[:, 3])
    to_hull = np.where(steep > 1e-9, depth / np.maximum(steep, 1e-9), np.inf).min(axis=1)
    points = centre + (to_hull + away_mm)[:, None] * directions
    away, _ = cKDTree(points_mm).query(points)
    return points, -away
