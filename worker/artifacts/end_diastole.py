"""Which frame of a cycle is end-diastole."""

from collections.abc import Sequence

import numpy as np

from schemas.frame_report import FrameReport
from schemas.vocabulary import Structure
from worker.artifacts.surface_sizes import areas_cm2, volumes_ml

_FIRST = (Structure.LV_ENDO, Structure.RV_ENDO)
"""Cavities tell it best: the left before the right."""


def end_diastole(frames: Sequence[FrameReport]) -> int:
    """Index of the frame of the largest left cavity; where none is closed, of the largest right
    one, else of the first surface of `Structure` that has a volume, or an area. 0 for frames
    without surfaces.
    """
    structures = dict.fromkeys([*_FIRST, *Structure])
    for sizes in (volumes_ml, areas_cm2):
        for structure in structures:
            found = np.array([one or 0.0 for one in sizes(frames, structure)])
            if found.any():
                return int(found.argmax())
    return 0
