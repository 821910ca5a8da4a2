"""Which long-axis view a plane is, by the direction in which the right ventricle lies.

A long-axis plane crosses the short-axis ones in a line. In two subjects with named views
(biv-me's and CAP's examples), that line lies 17 and 19 degrees off the direction from the left
to the right ventricle in four-chamber planes, 40 and 43 in three-chamber, 70 and 77 in
two-chamber ones, where the right ventricle is not outlined. Between, nothing is said.
"""

from collections.abc import Sequence, Set

import numpy as np
from numpy.typing import NDArray

from intake.planes import cross
from schemas.vocabulary import Structure, View

Array = NDArray[np.float64]

_ACROSS = np.cos(np.radians(70.0))
_FOUR_CHAMBERS = (0.0, 25.0)
_THREE_CHAMBERS = (34.0, 52.0)
_TWO_CHAMBERS = (62.0, 90.0)
_LEAST_APART_MM = 10.0

LEFT = frozenset((Structure.LV_ENDO, Structure.LV_EPI))
RIGHT = frozenset((Structure.RV_ENDO, Structure.RV_EPI))


def towards_right(
    left_mm: Sequence[Array], right_mm: Sequence[Array], normal: Array
) -> Array | None:
    """The unit direction, in the planes across `normal`, from the left ventricle's outlines to the
    right one's, each (n, 3); None where one is missing or they lie about one another.
    """
    if not left_mm or not right_mm:
        return None
    between = np.mean([p.mean(axis=0) for p in right_mm], axis=0) - np.mean(
        [p.mean(axis=0) for p in left_mm], axis=0
    )
    between = between - (between @ normal) * normal
    apart_mm = float(np.linalg.norm(between))
    return between / apart_mm if apart_mm >= _LEAST_APART_MM else None


def long_axis_view(
    plane_normal: Array, outlined: Set[Structure], normal: Array, right: Array
) -> View:
    """The view of a plane, `OTHER` where it is not sure. `normal` and `right` as above, unit."""
    if abs(plane_normal @ normal) > _ACROSS or not outlined & LEFT:
        return View.OTHER
    line = cross(normal, plane_normal)
    along = abs(float(line @ right)) / float(np.linalg.norm(line))
    off = float(np.degrees(np.arccos(min(1.0, along))))
    bands = (
        {View.LAX_4CH: _FOUR_CHAMBERS, View.LAX_3CH: _THREE_CHAMBERS}
        if outlined & RIGHT
        else {View.LAX_2CH: _TWO_CHAMBERS}
    )
    return next((v for v, (low, high) in bands.items() if low <= off <= high), View.OTHER)
