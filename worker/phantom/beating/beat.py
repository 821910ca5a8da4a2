"""The numbers of a beat, and the bounds within which it is one."""

from dataclasses import dataclass, field

from worker.phantom.beating.cycle import CardiacCycle
from worker.phantom.beating.infarct import Infarct
from worker.phantom.bounds import require_within

APEX_SHARE = 2.0 / 3.0
"""Of the twist, what the apex turns; the base turns by the rest the other way."""


@dataclass(frozen=True)
class Beat:
    """How a heart beats. The defaults are those of a healthy adult at rest.

    edv_ml: LV volume at end-diastole, by scaling the whole heart; None leaves its shape as it is.
    ejection_fraction_percent, rv_ejection_fraction_percent: of LV and RV.
    longitudinal_shortening_percent: of the length from apex to base, at end-systole.
    twist_deg: at end-systole, turn of the apex against the base. The apex turns counter-clockwise
        seen from the apex, by two thirds of it, the base clockwise by one third.
    infarct: where the LV wall does not squeeze; None: nowhere.
    """

    cycle: CardiacCycle = field(default_factory=CardiacCycle)
    edv_ml: float | None = None
    ejection_fraction_percent: float = 60.0
    rv_ejection_fraction_percent: float = 55.0
    longitudinal_shortening_percent: float = 15.0
    twist_deg: float = 12.0
    infarct: Infarct | None = None

    def __post_init__(self) -> None:
        if self.edv_ml is not None:
            require_within("edv_ml", self.edv_ml, 30.0, 400.0)
        require_within("ejection_fraction_percent", self.ejection_fraction_percent, 0.0, 75.0)
        require_within("rv_ejection_fraction_percent", self.rv_ejection_fraction_percent, 0.0, 75.0)
        require_within(
            "longitudinal_shortening_percent", self.longitudinal_shortening_percent, 0.0, 30.0
        )
        require_within("twist_deg", self.twist_deg, -40.0, 40.0)
