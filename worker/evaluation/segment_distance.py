"""How far points are from line segments in space."""

import igl
import numpy as np
from jaxtyping import Int

from worker.arrays import Points, Scalars, SomePoints

Segments = Int[np.ndarray, "_ 2"]
"""Indices of both ends of each segment."""


def ring_segments(count: int) -> Segments:
    """The segments that join `count` points to a ring, the last to the first."""
    starts = np.arange(count)
    return np.stack([starts, (starts + 1) % count], axis=1)


def distance_to_segments_mm(points_mm: Points, ends_mm: SomePoints, segments: Segments) -> Scalars:
    """Exact distance from each of (n, 3) points to the nearest segment, (n,) mm.

    ends_mm: (k, 3), what `segments` points into; there is at least one segment.
    """
    ends = np.ascontiguousarray(ends_mm, dtype=np.float64)
    pairs = np.ascontiguousarray(segments, dtype=np.int64)
    boxes = igl.AABB()
    boxes.init(ends, pairs)
    points = np.ascontiguousarray(points_mm, dtype=np.float64)
    squared, _, _ = boxes.squared_distance(ends, pairs, points)
    distances: Scalars = np.sqrt(np.maximum(squared, 0.0))
    return distances
