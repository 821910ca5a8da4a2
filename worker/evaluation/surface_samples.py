"""Points spread evenly over a surface."""

import numpy as np

from worker.arrays import Points
from worker.evaluation.size import triangle_areas_mm2
from worker.surface_mesh import SurfaceMesh


def area_uniform_samples_mm(
    mesh: SurfaceMesh, count: int, generator: np.random.Generator
) -> Points:
    """(count, 3) random points in mm, uniform over the area: dense triangles weigh no more.

    Within a triangle by the square-root map (Turk, Graphics Gems 1990).
    """
    areas = triangle_areas_mm2(mesh)
    chosen = generator.choice(len(areas), size=count, p=areas / areas.sum())
    root, along = np.sqrt(generator.random(count)), generator.random(count)
    weights = np.stack([1.0 - root, root * (1.0 - along), root * along], axis=1)
    samples: Points = np.einsum("nk,nkd->nd", weights, mesh.triangles_mm[chosen])
    return samples
