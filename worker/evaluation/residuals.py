"""How far observed contours are from the surface that was made of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from worker.arrays import Scalars, SomeScalars, Vector
from worker.evaluation.distance import points_to_surface_mm
from worker.evaluation.support import AlignedOutline
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True, eq=False)
class Residuals:
    """Exact distances (n,) from the points of one outline to the surface, mm, and its points."""

    outline: AlignedOutline
    distances_mm: Scalars


def contour_residuals(mesh: SurfaceMesh, outlines: Sequence[AlignedOutline]) -> list[Residuals]:
    """Of every outline of a surface, at its points: chords at the valves are no observation."""
    return [Residuals(one, points_to_surface_mm(one.points_mm, mesh)) for one in outlines]


def by_thirds(
    residuals: Sequence[Residuals], mesh: SurfaceMesh, toward_base: Vector
) -> tuple[SomeScalars, SomeScalars, SomeScalars]:
    """All distances in the apical, middle and basal third of the surface's extent along the unit
    vector `toward_base` (3,), each (k,) mm. What lies beyond an end belongs to that end.
    """
    heights = mesh.vertices_mm @ toward_base
    cuts = np.linspace(heights.min(), heights.max(), 4)[1:3]
    points = [one.outline.points_mm @ toward_base for one in residuals]
    third = np.searchsorted(cuts, np.concatenate([*points, np.empty(0)]))
    distances = np.concatenate([*(one.distances_mm for one in residuals), np.empty(0)])
    return distances[third == 0], distances[third == 1], distances[third == 2]
