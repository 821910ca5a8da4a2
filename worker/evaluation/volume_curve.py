"""How fast a chamber empties and fills: the slopes of its volume over time."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline

from schemas.cycle_report import FEWEST_FRAMES

Frames = Float[np.ndarray, " frames"]
"""One number a frame, in the order of time."""

_HARMONICS = 10
"""Of a whole cycle's volume curve; a finer wave of it is the frames' own error rather than flow."""

_EVEN = 0.05
"""By how much of a step frames may be uneven and still be taken as evenly spaced."""


@dataclass(frozen=True)
class PeakRates:
    """Fastest fall and fastest rise of a volume, mL/s, 0 or more."""

    ejection_ml_per_s: float
    filling_ml_per_s: float


def period_ms(times_ms: Frames) -> float:
    """How long a cycle lasts whose frames are these, two or more in order: from the first to the
    last, and a median step from there to the next beat's first.
    """
    return float(times_ms[-1] - times_ms[0] + np.median(np.diff(times_ms)))


def peak_rates(
    volumes_ml: Frames, times_ms: Frames, cycle_ms: float | None = None
) -> PeakRates | None:
    """The steepest slopes of a smooth curve through the volumes, wherever between frames they lie.

    The curve is a cubic spline. Of a whole cycle it is periodic, and where frames are evenly spaced
    it has ten harmonics at most: with 21 frames or fewer it goes through all of them, with more the
    harmonics beyond are taken off first. Without `cycle_ms`, the period of a whole cycle, it goes
    through all frames, its third derivative continuous at the second and last but one.

    None for fewer than three frames, or times that do not grow.
    """
    steps_ms = np.diff(times_ms)
    if len(volumes_ml) < FEWEST_FRAMES or not (steps_ms > 0.0).all():
        return None
    if cycle_ms is None:
        curve = CubicSpline(times_ms, volumes_ml)
    else:
        steps_ms = np.append(steps_ms, times_ms[0] + cycle_ms - times_ms[-1])
        smooth = _few_harmonics(volumes_ml) if _are_even(steps_ms) else volumes_ml
        times = np.append(times_ms, times_ms[0] + cycle_ms)
        curve = CubicSpline(times, np.append(smooth, smooth[0]), bc_type="periodic")
    turns = curve.derivative(2).roots(extrapolate=False)
    slopes = curve(np.concatenate([curve.x, turns[np.isfinite(turns)]]), 1) * 1000.0
    return PeakRates(max(0.0, float(-slopes.min())), max(0.0, float(slopes.max())))


def _few_harmonics(volumes_ml: Frames) -> Frames:
    waves = np.fft.rfft(volumes_ml)
    waves[_HARMONICS + 1 :] = 0.0
    smooth: Frames = np.fft.irfft(waves, len(volumes_ml))
    return smooth


def _are_even(steps_ms: Frames) -> bool:
    return bool(np.abs(steps_ms - steps_ms.mean()).max() <= _EVEN * steps_ms.mean())
