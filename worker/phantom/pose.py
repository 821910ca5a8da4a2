"""Where the heart lies in the patient."""

from dataclasses import dataclass, field

import numpy as np

from worker.arrays import Points, Rotation, Vector


def _oblique() -> Rotation:
    """The heart's axes as a patient has them: apex to the left, front and below; RV to the right.

    Columns are the heart's x (LV to RV), y and z (apex to base) in LPS.
    """
    z = np.array([-0.50, 0.42, 0.76])
    z /= np.linalg.norm(z)
    towards_rv = np.array([-0.85, -0.50, 0.0])
    x = towards_rv - z * (towards_rv @ z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


@dataclass(frozen=True, eq=False)
class Pose:
    """A rigid motion from the heart's own frame (mm) to the patient frame (mm)."""

    rotation: Rotation = field(default_factory=_oblique)
    translation_mm: Vector = field(default_factory=lambda: np.array([28.0, -35.0, -22.0]))

    def to_patient(self, points_mm: Points) -> Points:
        """Points (n, 3) of the heart's frame, in the patient frame."""
        moved: Points = points_mm @ self.rotation.T + self.translation_mm
        return moved

    def to_heart(self, points_mm: Points) -> Points:
        """Points (n, 3) of the patient frame, in the heart's frame."""
        moved: Points = (points_mm - self.translation_mm) @ self.rotation
        return moved
