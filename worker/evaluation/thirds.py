"""A surface in three parts: apical, middle and basal third of its extent along the long axis."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from worker.arrays import Points, Scalars, Vector
from worker.surface_mesh import SurfaceMesh


class Region(StrEnum):
    """A third of a surface's extent, in the order of the long axis."""

    APEX = "apex"
    MID = "mid"
    BASE = "base"


@dataclass(frozen=True, eq=False)
class Thirds:
    """Two planes across the long axis, at heights (2,) in mm along the unit vector (3,).

    What lies beyond the surface's ends belongs to the apex or the base.
    """

    towards_base: Vector
    cuts_mm: np.ndarray

    def of(self, points_mm: Points) -> np.ndarray:
        """Index of the region of each of (n, 3) points: 0 apex, 1 mid, 2 base."""
        return np.searchsorted(self.cuts_mm, points_mm @ self.towards_base)

    def volumes_ml(self, mesh: SurfaceMesh) -> np.ndarray:
        """What a closed, outward mesh encloses in each region, (3,), mL; exact, sum is the whole.

        Divergence theorem: the field `max(h - cut, 0) * towards_base`, h the height, has divergence
        one above the cut and zero below it.
        """
        corners = mesh.triangles_mm
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        facing_base_mm2 = normals @ self.towards_base / 2.0
        heights = corners @ self.towards_base
        lowest = heights.min()
        above = [
            float(facing_base_mm2 @ mean_excess(heights - cut)) for cut in (lowest, *self.cuts_mm)
        ]
        return -np.diff([*above, 0.0]) / 1000.0


def thirds(mesh: SurfaceMesh, towards_base: Vector) -> Thirds:
    """The thirds of a surface's extent along a unit vector."""
    heights = mesh.vertices_mm @ towards_base
    return Thirds(towards_base, np.linspace(heights.min(), heights.max(), 4)[1:3])


def mean_excess(heights: np.ndarray) -> Scalars:
    """Mean over triangles of max(h, 0), h linear with values (n, 3) at the corners; (n,).

    With one corner above zero, the part above is a smaller triangle, over which h is on average a
    third of that corner's; with one below, the same part below is added back to the mean of h.
    """
    low, middle, high = np.sort(heights, axis=1).T
    mean = heights.mean(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        peak = high / 3.0 * (high / (high - low)) * (high / (high - middle))
        pit = -low / 3.0 * (low / (low - high)) * (low / (low - middle))
    return np.select([low >= 0.0, high <= 0.0, middle <= 0.0], [mean, 0.0, peak], mean + pit)
