"""Beats by name: a sound heart, and two that are not."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType

from worker.phantom.beating.beat import Beat
from worker.phantom.beating.infarct import Infarct
from worker.phantom.shape import HeartShape


class BeatPreset(StrEnum):
    """What is the matter with the heart."""

    HEALTHY = "healthy"
    DILATED = "dilated"
    INFARCT = "infarct"


@dataclass(frozen=True)
class Case:
    """A heart and how it beats."""

    shape: HeartShape = field(default_factory=HeartShape)
    beat: Beat = field(default_factory=Beat)


# In each of them the RV's ejection fraction makes both ventricles eject the same to within 1 mL.
PRESETS: Mapping[BeatPreset, Case] = MappingProxyType(
    {
        BeatPreset.HEALTHY: Case(),
        BeatPreset.DILATED: Case(
            HeartShape(
                lv_radius_mm=32.0,
                lv_apex_depth_mm=72.0,
                base_height_mm=26.0,
                rv_reach_mm=22.0,
                rv_breadth_ratio=0.95,
                rv_depth_ratio=0.75,
            ),
            Beat(
                ejection_fraction_percent=25.0,
                rv_ejection_fraction_percent=53.0,
                longitudinal_shortening_percent=7.0,
                twist_deg=4.0,
            ),
        ),
        BeatPreset.INFARCT: Case(
            beat=Beat(
                ejection_fraction_percent=40.0,
                rv_ejection_fraction_percent=37.0,
                longitudinal_shortening_percent=9.0,
                twist_deg=6.0,
                infarct=Infarct(),
            )
        ),
    }
)
"""Each preset's heart: healthy; dilated and weak all over; with an anterior wall that bulges."""
