"""The time course of a beat: when the ventricles empty, twist, and fill."""

from dataclasses import dataclass

import numpy as np

from worker.arrays import Scalars
from worker.phantom.beating.smooth_step import smooth_step
from worker.phantom.bounds import require_within

_ISOVOLUMIC_CONTRACTION_MS = 40.0
_ISOVOLUMIC_RELAXATION_MS = 70.0
_RAPID_FILLING_MS = 190.0
_ATRIAL_KICK_MS = 120.0

_KICK_SHARE = 0.22
"""Of the stroke volume, what the atria push in at the end of diastole."""


@dataclass(frozen=True)
class CardiacCycle:
    """When things happen, in ms after end-diastole (the closing of the mitral valve).

    Ejection lasts 413 - 1.7 x the heart rate (Weissler, Harris and Schoenfeld, Circulation 1968).
    Diastole has what is left: relaxation at constant volume, rapid filling, diastasis, atrial kick;
    where a fast heart leaves no time for them, there is no diastasis and the others are shorter.
    """

    heart_rate_bpm: float = 60.0

    def __post_init__(self) -> None:
        require_within("heart_rate_bpm", self.heart_rate_bpm, 40.0, 150.0)

    @property
    def duration_ms(self) -> float:
        """One beat."""
        return 60_000.0 / self.heart_rate_bpm

    @property
    def end_systole_ms(self) -> float:
        """When the volume is least; it stays so until `filling_ms`."""
        return _ISOVOLUMIC_CONTRACTION_MS + 413.0 - 1.7 * self.heart_rate_bpm

    @property
    def filling_ms(self) -> float:
        """When the mitral valve opens."""
        return self.end_systole_ms + self._haste * _ISOVOLUMIC_RELAXATION_MS

    @property
    def diastasis_ms(self) -> float:
        """When rapid filling is over."""
        return self.filling_ms + self._haste * _RAPID_FILLING_MS

    @property
    def kick_ms(self) -> float:
        """When the atria contract."""
        return self.duration_ms - self._haste * _ATRIAL_KICK_MS

    @property
    def _haste(self) -> float:
        """What share of the time that they take at rest the phases of diastole have."""
        at_rest = _ISOVOLUMIC_RELAXATION_MS + _RAPID_FILLING_MS + _ATRIAL_KICK_MS
        return min(1.0, (self.duration_ms - self.end_systole_ms) / at_rest)

    def frame_times_ms(self, count: int) -> Scalars:
        """`count` instants evenly over one beat, the first at end-diastole, the next beat's not."""
        return np.arange(count) * (self.duration_ms / count)

    def contraction(self, times_ms: Scalars) -> Scalars:
        """Share of the stroke volume that is out, at any times: 0 at end-diastole, 1 at
        end-systole.
        """
        at = np.mod(times_ms, self.duration_ms)
        ejected, _ = smooth_step(at, _ISOVOLUMIC_CONTRACTION_MS, self.end_systole_ms)
        rapid, _ = smooth_step(at, self.filling_ms, self.diastasis_ms)
        kick, _ = smooth_step(at, self.kick_ms, self.duration_ms)
        return ejected - (1.0 - _KICK_SHARE) * rapid - _KICK_SHARE * kick

    def twist(self, times_ms: Scalars) -> Scalars:
        """Share of the peak twist, at any times: 1 at end-systole.

        The ventricle recoils sooner than it fills: two fifths of the twist are gone when the
        mitral valve opens.
        """
        at = np.mod(times_ms, self.duration_ms)
        wound, _ = smooth_step(at, 0.0, self.end_systole_ms)
        half_filled_ms = (self.filling_ms + self.diastasis_ms) / 2.0
        recoiled, _ = smooth_step(at, self.end_systole_ms, half_filled_ms)
        return wound - recoiled
