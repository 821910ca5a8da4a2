"""The analytic heart over a whole beat: known motion of every material point."""

from worker.phantom.beating.beat import Beat
from worker.phantom.beating.beating_heart import BeatingHeart, MovingSurface
from worker.phantom.beating.cycle import CardiacCycle
from worker.phantom.beating.infarct import Infarct
from worker.phantom.beating.presets import PRESETS, BeatPreset, Case
from worker.phantom.beating.sliced_beat import SlicedBeat, sliced_beat

__all__ = [
    "PRESETS",
    "Beat",
    "BeatPreset",
    "BeatingHeart",
    "CardiacCycle",
    "Case",
    "Infarct",
    "MovingSurface",
    "SlicedBeat",
    "sliced_beat",
]
