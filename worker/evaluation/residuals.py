"""How closely a surface passes through the contours it was made from."""

import numpy as np

from worker.arrays import Scalars, SomePoints
from worker.evaluation.distance import points_to_surface_mm
from worker.surface_mesh import SurfaceMesh


def contour_residuals_mm(
    points_mm: SomePoints,
    mesh: SurfaceMesh,
    *,
    closed: bool = True,
    spacing_mm: float | None = None,
) -> Scalars:
    """Exact distances in mm from an outline to the surface.

    points_mm: (n, 3) along one contour. spacing_mm: None measures at the given points themselves;
    a length measures at points that far apart along the outline, so that densely drawn stretches
    weigh no more. closed: whether the last point joins the first; the chord that closes an open
    contour is no observation and is not measured.
    """
    measured = points_mm if spacing_mm is None else _resampled(points_mm, closed, spacing_mm)
    return points_to_surface_mm(measured, mesh)


def _resampled(points_mm: SomePoints, closed: bool, spacing_mm: float) -> SomePoints:
    line = np.vstack([points_mm, points_mm[:1]]) if closed else points_mm
    length = np.concatenate([[0.0], np.linalg.norm(np.diff(line, axis=0), axis=1).cumsum()])
    steps = max(1, round(length[-1] / spacing_mm))
    # A closed outline ends where it began: its last step is not measured twice.
    at = np.linspace(0.0, length[-1], steps + 1)[: steps if closed else None]
    return np.column_stack([np.interp(at, length, line[:, axis]) for axis in range(3)])
