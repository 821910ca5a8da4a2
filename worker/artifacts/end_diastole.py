"""Which frame of a cycle is end-diastole."""

from collections.abc import Callable, Sequence

import numpy as np

from schemas.frame_report import FrameReport
from schemas.surface_report import SurfaceReport
from schemas.vocabulary import Structure

Series = list[float | None]

_FIRST = (Structure.LV_ENDO, Structure.RV_ENDO)
"""Cavities tell it best: the left before the right."""


def volumes_ml(frames: Sequence[FrameReport], structure: Structure) -> Series:
    """Of a surface, by frame; None where it is open or not there."""
    return _series(frames, structure, lambda surface: surface.volume_ml)


def areas_cm2(frames: Sequence[FrameReport], structure: Structure) -> Series:
    """Of a surface, by frame; None where it is not there."""
    return _series(frames, structure, lambda surface: surface.area_cm2)


def end_diastole(frames: Sequence[FrameReport]) -> int:
    """Index of the frame of the largest left cavity; where none is closed, of the largest right
    one, else of the largest surface that has a volume, else of the largest by area. 0 for frames
    without surfaces.
    """
    structures = dict.fromkeys([*_FIRST, *Structure])
    for sizes in (volumes_ml, areas_cm2):
        for structure in structures:
            found = np.array([one or 0.0 for one in sizes(frames, structure)])
            if found.any():
                return int(found.argmax())
    return 0


def _series(
    frames: Sequence[FrameReport],
    structure: Structure,
    size: Callable[[SurfaceReport], float | None],
) -> Series:
    return [size(f.surfaces[structure]) if structure in f.surfaces else None for f in frames]
