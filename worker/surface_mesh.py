"""The triangle mesh that every room speaks of: vertices in mm, patient frame."""

from dataclasses import dataclass

import numpy as np

from worker.arrays import Faces, Points


@dataclass(frozen=True, eq=False)
class SurfaceMesh:
    """A triangulated surface.

    vertices_mm: (n, 3) float64, patient axes of the study (LPS or RAS), mm.
    faces: (m, 3) int64, counter-clockwise seen from outside.
    """

    vertices_mm: Points
    faces: Faces

    @property
    def triangles_mm(self) -> np.ndarray:
        """Corner positions, (m, 3, 3), mm."""
        return self.vertices_mm[self.faces]
