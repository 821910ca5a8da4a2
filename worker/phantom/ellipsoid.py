"""An ellipsoid in closed form: signed distance to its surface, volume under a plane."""

from dataclasses import dataclass

import numpy as np

from worker.arrays import Points, Scalars


@dataclass(frozen=True)
class Ellipsoid:
    """An ellipsoid along the axes of the heart's own frame, mm."""

    centre_mm: tuple[float, float, float]
    semi_axes_mm: tuple[float, float, float]

    def signed_mm(self, points_mm: Points) -> Scalars:
        """Signed distance, negative inside, at points (n, 3) of the heart's own frame.

        Exact in sign, and to first order at the surface: with q = (p - c) / r it is the level
        |q| (|q| - 1) over its slope |q / r|.
        """
        semi_axes = np.array(self.semi_axes_mm)
        scaled = (points_mm - np.array(self.centre_mm)) / semi_axes
        level = np.linalg.norm(scaled, axis=1)
        slope = np.linalg.norm(scaled / semi_axes, axis=1)
        # At the very centre both vanish; the depth there is the shortest semi-axis.
        at_centre = level < 1e-9
        signed: Scalars = level * (level - 1.0) / np.where(at_centre, 1.0, slope)
        signed[at_centre] = -semi_axes.min()
        return signed

    def volume_below_ml(self, plane_mm: float) -> float:
        """Volume under the plane z = plane_mm, which must cut the ellipsoid, in mL."""
        a, b, c = self.semi_axes_mm
        height = plane_mm - self.centre_mm[2]
        length = height - height**3 / (3.0 * c**2) + 2.0 * c / 3.0
        return float(np.pi * a * b * length / 1000.0)
