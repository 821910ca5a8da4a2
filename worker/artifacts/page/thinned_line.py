"""A flat line in space with fewer points, as near to it as the eye can tell."""

import numpy as np
from shapely import LineString

from worker.arrays import SomePoints

_TOLERANCE_MM = 0.1


def thinned_line(points_mm: SomePoints) -> SomePoints:
    """Some of the points (k, 3), mm, of a line in a plane, the ends among them: all others are
    within 0.1 mm.
    """
    if len(points_mm) < 3:
        return points_mm
    centre = points_mm.mean(axis=0)
    _, _, across = np.linalg.svd(points_mm - centre, full_matrices=False)
    flat = (points_mm - centre) @ across[:2].T
    kept = np.array(LineString(flat).simplify(_TOLERANCE_MM, preserve_topology=False).coords)
    return np.asarray(kept @ across[:2] + centre)
