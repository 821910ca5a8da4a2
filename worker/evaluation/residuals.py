"""How far observed contours are from the surface that was made of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from worker.arrays import Scalars, SomeScalars, Vector
from worker.evaluation.distance import points_to_surface_mm
from worker.evaluation.support import AlignedOutline
from worker.evaluation.thirds import thirds
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True, eq=False)
class Residuals:
    """Exact distances (n,) from the points of one outline to the surface, mm, and its points."""

    outline: AlignedOutline
    distances_mm: Scalars


def contour_residuals(mesh: SurfaceMesh, outlines: Sequence[AlignedOutline]) -> list[Residuals]:
    """Of every outline of a surface, at its points: chords at the valves are no observation."""
    return [Residuals(one, points_to_surface_mm(one.points_mm, mesh)) for one in outlines]


def all_distances_mm(residuals: Sequence[Residuals]) -> Scalars:
    """Of all outlines, (n,) mm, in order."""
    return np.concatenate([*(one.distances_mm for one in residuals), np.empty(0)])


def by_thirds(
    residuals: Sequence[Residuals], mesh: SurfaceMesh, toward_base: Vector
) -> tuple[SomeScalars, SomeScalars, SomeScalars]:
    """All distances in the apical, middle and basal third of the surface's extent along the unit
    vector `toward_base` (3,), each (k,) mm. What lies beyond an end belongs to that end.
    """
    points = [one.outline.points_mm for one in residuals]
    third = thirds(mesh, toward_base).of(np.concatenate([*points, np.empty((0, 3))]))
    distances = all_distances_mm(residuals)
    return distances[third == 0], distances[third == 1], distances[third == 2]
