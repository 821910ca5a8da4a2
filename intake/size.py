"""Is the study as large as a heart? The one check that sees a wrong length unit."""

import numpy as np
from numpy.typing import NDArray

from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy
from schemas.vocabulary import Units

Array = NDArray[np.float64]

SMALLEST_MM, LARGEST_MM = 2.0, 400.0
"""Extent of what can be a heart: below a newborn mouse's, above a horse's ventricles."""

SMALL_ANIMAL_MM = 40.0
"""Below this a heart is no human's, not even an infant's."""


def check_extent(study: ContourStudy, pointer: str) -> tuple[float, list[str]]:
    """Extent of all contours, mm (diagonal of their box), and warnings.

    Raises:
        InputError: `IMPLAUSIBLE_SIZE`, naming the unit that would fit, or the point that strays.
    """
    clouds = [
        (f"{pointer}/frames/{i}/slices/{j}/contours/{k}", np.array(c.points, dtype=np.float64))
        for i, frame in enumerate(study.frames)
        for j, slice_ in enumerate(frame.slices)
        for k, c in enumerate(slice_.contours)
    ]
    if not clouds:
        return 0.0, []
    points = np.concatenate([cloud for _, cloud in clouds])
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    extent_mm = extent * study.units.millimetres
    if not SMALLEST_MM <= extent_mm <= LARGEST_MM:
        _refuse(extent, extent_mm, study.units, clouds, pointer)
    if extent_mm < SMALL_ANIMAL_MM:
        return extent_mm, [
            f"The contours span {extent_mm:.3g} mm, the size of a small animal's heart; "
            f"for a human heart the units are not {study.units.value}."
        ]
    return extent_mm, []


def _refuse(
    extent: float, extent_mm: float, units: Units, clouds: list[tuple[str, Array]], pointer: str
) -> None:
    said = (
        f"The contours span {extent_mm:.3g} mm; a heart spans {SMALLEST_MM:g} to {LARGEST_MM:g} mm."
    )
    stray = _stray_point(clouds, units) if extent_mm > LARGEST_MM else None
    if stray is not None:
        raise InputError(
            ProblemType.IMPLAUSIBLE_SIZE,
            f"{said} This point lies far from all others. Remedy: correct or remove it.",
            pointer=stray,
        )
    # A human heart first: several units can be plausible, and most hearts are human.
    fitting = [u for u in Units if SMALLEST_MM <= extent * u.millimetres <= LARGEST_MM]
    fitting.sort(key=lambda u: extent * u.millimetres < SMALL_ANIMAL_MM)
    if fitting:
        remedy = f'the coordinates look like {_SPELLED[fitting[0]]}: set units to "{fitting[0]}"'
    else:
        remedy = (
            "no unit makes it a heart; send patient coordinates (not pixel indices) and check for "
            "points that stray"
        )
    raise InputError(
        ProblemType.IMPLAUSIBLE_SIZE, f"{said} Remedy: {remedy}.", pointer=f"{pointer}/units"
    )


_SPELLED = {
    Units.MM: "millimetres",
    Units.CM: "centimetres",
    Units.M: "metres",
    Units.UM: "micrometres",
}


def _stray_point(clouds: list[tuple[str, Array]], units: Units) -> str | None:
    """Pointer of the farthest point, when without the farthest percent the size is a heart's."""
    points = np.concatenate([cloud for _, cloud in clouds]) * units.millimetres
    distance = np.linalg.norm(points - np.median(points, axis=0), axis=1)
    kept = points[distance <= np.quantile(distance, 0.99, method="lower")]
    if not SMALLEST_MM <= np.linalg.norm(np.ptp(kept, axis=0)) <= LARGEST_MM:
        return None
    at = int(np.argmax(distance))
    for pointer, cloud in clouds:
        if at < len(cloud):
            return f"{pointer}/points/{at}"
        at -= len(cloud)
    return None
