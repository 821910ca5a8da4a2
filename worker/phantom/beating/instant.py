"""The numbers that place every point of the heart at one instant of the beat."""

from dataclasses import dataclass

import numpy as np

from schemas.problem import InputError, ProblemType
from worker.arrays import Scalars
from worker.phantom.beating.beat import Beat
from worker.phantom.beating.profile import Profile

_LEAST_RADIUS_SHARE = 0.25
"""A cavity whose radius comes down to less than this, of what it would be by shortening alone, has
all but vanished."""


@dataclass(frozen=True)
class Instant:
    """One instant.

    stretch: of lengths along the axis; 1 at end-diastole.
    squeeze: of sound wall; the cavity's squared radius, over its own at end-diastole, is
        1 / stretch less this.
    infarct_squeeze: the same of the infarct; negative where it bulges.
    rv_share: volume of the RV cavity over its own at end-diastole.
    twist_rad: turn of the apex against the base.
    """

    stretch: float
    squeeze: float
    infarct_squeeze: float
    rv_share: float
    twist_rad: float


def instants(profile: Profile, beat: Beat, times_ms: Scalars) -> list[Instant]:
    """The numbers at each of `times_ms`.

    Raises InputError where what is asked of the sound wall would close the cavity.
    """
    edv_ml = profile.layout.lv_inner.volume_below_ml(profile.base_mm)
    emptied = beat.cycle.contraction(times_ms)
    wound = beat.cycle.twist(times_ms)
    found = []
    for out, turned in zip(emptied.tolist(), wound.tolist(), strict=True):
        stretch = 1.0 - beat.longitudinal_shortening_percent / 100.0 * out
        stroke_ml = edv_ml * beat.ejection_fraction_percent / 100.0 * out
        infarct = _infarct_squeeze(profile, stretch)
        sound_ml = profile.squeezed_ml - profile.infarcted_ml
        squeeze = (stroke_ml / stretch - infarct * profile.infarcted_ml) / sound_ml
        if squeeze * stretch > 1.0 - _LEAST_RADIUS_SHARE**2:
            raise InputError(
                ProblemType.INVALID_REQUEST,
                "The cavity would close before so much is ejected; ask for a lower "
                "ejection_fraction_percent, or a smaller infarct.",
                pointer="/ejection_fraction_percent",
            )
        rv = 1.0 - beat.rv_ejection_fraction_percent / 100.0 * out
        twist = float(np.radians(beat.twist_deg)) * turned
        found.append(Instant(stretch, squeeze, infarct, rv, twist))
    return found


def _infarct_squeeze(profile: Profile, stretch: float) -> float:
    """The squeeze of an infarct whose wall, in the middle of its height, keeps its thickness.

    What it loses along the axis, it gains around it: from r_o - r_i = h and
    r_o^2 - r_i^2 = (R_o^2 - R_i^2) / stretch follows r_o, and from it what was squeezed.
    """
    if profile.infarct is None:
        return 0.0
    depth = profile.layout.lv_inner.semi_axes_mm[2]
    middle = np.array([((profile.infarct.low + profile.infarct.high) / 2.0 - 1.0) * depth])
    inner, outer = profile.cavity_mm2(middle)[0][0], profile.outer_mm2(middle)[0][0]
    thickness = np.sqrt(outer) - np.sqrt(inner)
    kept_outer = ((outer - inner) / stretch / thickness + thickness) / 2.0
    shed = outer / stretch - kept_outer**2
    return float(shed / (inner * profile.squeeze(middle)[0][0]))
