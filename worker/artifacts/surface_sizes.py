"""How large a surface is, frame by frame."""

from collections.abc import Callable, Sequence

from schemas.cycle_report import Series
from schemas.frame_report import FrameReport
from schemas.surface_report import SurfaceReport
from schemas.vocabulary import Structure


def volumes_ml(frames: Sequence[FrameReport], structure: Structure) -> Series:
    """Of a surface, by frame; None where it is open or not there."""
    return _series(frames, structure, lambda surface: surface.volume_ml)


def areas_cm2(frames: Sequence[FrameReport], structure: Structure) -> Series:
    """Of a surface, by frame; None where it is not there."""
    return _series(frames, structure, lambda surface: surface.area_cm2)


def _series(
    frames: Sequence[FrameReport],
    structure: Structure,
    size: Callable[[SurfaceReport], float | None],
) -> Series:
    return [size(f.surfaces[structure]) if structure in f.surfaces else None for f in frames]
