"""The segments of the left ventricle's wall, as the American Heart Association numbers them.

Cerqueira et al., Circulation 105:539-542, 2002: basal and mid-cavity thirds in six segments each,
the apical third in four, and the apex beyond the cavity as the seventeenth.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from schemas.problem import InternalError, ProblemType
from worker.arrays import Points, Vector

APEX = 17
"""The wall beyond the cavity's apical end."""

NONE = 0
"""What lies above the base."""

NAMES = {
    1: "basal anterior",
    2: "basal anteroseptal",
    3: "basal inferoseptal",
    4: "basal inferior",
    5: "basal inferolateral",
    6: "basal anterolateral",
    7: "mid anterior",
    8: "mid anteroseptal",
    9: "mid inferoseptal",
    10: "mid inferior",
    11: "mid inferolateral",
    12: "mid anterolateral",
    13: "apical anterior",
    14: "apical septal",
    15: "apical inferior",
    16: "apical lateral",
    17: "apex",
}

_SIX = np.array([2, 1, 6, 5, 4, 3])
"""Basal segments from the right ventricle's direction on, toward the front, sixty degrees each."""

_FOUR = np.array([14, 13, 16, 15])
"""Apical segments likewise, ninety degrees each, the first about the direction itself."""


@dataclass(frozen=True, eq=False)
class LeftVentricle:
    """Where the left ventricle lies, patient axes (LPS or RAS, both right-handed).

    centre_mm: (3,) a point of its long axis. toward_base: (3,) unit vector along it, from the apex.
    toward_rv: (3,) to the right ventricle, of any length and not along the axis. apex_mm, base_mm:
    heights along `toward_base`, from `centre_mm`, of the cavity's apical end and of its base.
    """

    centre_mm: Vector
    toward_base: Vector
    toward_rv: Vector
    apex_mm: float
    base_mm: float

    def __post_init__(self) -> None:
        if self.apex_mm >= self.base_mm:
            raise InternalError(
                ProblemType.INTERNAL,
                f"The cavity's apex ({self.apex_mm:.1f} mm) is not below its base "
                f"({self.base_mm:.1f} mm); turn the long axis from apex to base.",
            )


def aha_segments(points_mm: Points, ventricle: LeftVentricle) -> Int[np.ndarray, " n"]:
    """The segment of each of (n, 3) points, patient mm: 1 to 17, or NONE above the base.

    The middle of the septum faces the right ventricle: segments 2 and 3 meet there. Seen from the
    apex, with the right ventricle at the left, the anterior wall is on top.
    """
    axis = ventricle.toward_base
    septal = ventricle.toward_rv - axis * float(axis @ ventricle.toward_rv)
    septal = septal / np.linalg.norm(septal)
    anterior = np.cross(axis, septal)
    from_centre = points_mm - ventricle.centre_mm
    degrees = np.degrees(np.arctan2(from_centre @ anterior, from_centre @ septal)) % 360.0
    height = from_centre @ axis
    third = (height - ventricle.apex_mm) / (ventricle.base_mm - ventricle.apex_mm) * 3.0
    six = _SIX[np.minimum(degrees // 60.0, 5.0).astype(np.int64)]
    four = _FOUR[((degrees + 45.0) % 360.0 // 90.0).astype(np.int64) % 4]
    segments = np.select(
        [third < 0.0, third < 1.0, third < 2.0, third <= 3.0], [APEX, four, six + 6, six], NONE
    )
    return segments.astype(np.int64)
