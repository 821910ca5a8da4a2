"""How much of a surface is worse than most of its points."""

import numpy as np

from worker.arrays import Scalars
from worker.evaluation.size import triangle_areas_mm2
from worker.surface_mesh import SurfaceMesh


def area_above_percentile_percent(areas_mm2: Scalars, amounts: Scalars, percent: float) -> float:
    """Share of the area whose amount is above the `percent`-th percentile of the points, percent.

    areas_mm2: (n,) about each point, some positive; a point without any does not count. amounts:
    (n,), 0 or more. Not 100 less `percent`: points lie denser in one place than in another. 0 where
    all amounts are the same.
    """
    counts = areas_mm2 > 0.0
    areas, values = areas_mm2[counts], amounts[counts]
    above = values > np.percentile(values, percent)
    return float(100.0 * areas[above].sum() / areas.sum())


def vertex_areas_mm2(mesh: SurfaceMesh) -> Scalars:
    """Area about each vertex, (n,): a third of its triangles'. 0 for a vertex in no triangle."""
    thirds = np.repeat(triangle_areas_mm2(mesh) / 3.0, 3)
    areas: Scalars = np.bincount(mesh.faces.ravel(), thirds, minlength=len(mesh.vertices_mm))
    return areas
