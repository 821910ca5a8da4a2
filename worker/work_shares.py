"""How a job's time divides: into reconstructing, tracking, measuring and writing."""

from dataclasses import dataclass

from intake.effort import effort
from intake.support import frame_surfaces
from schemas.options import Options
from schemas.study import ContourStudy

TRACKING_COST = 0.15
MEASURING_COST = 0.12
WRITING_COST = 0.06
"""Of a frame, in plain fits of one: what a bar that runs evenly needs, and no more exact."""


@dataclass(frozen=True)
class WorkShares:
    """Fractions of the whole up to which each part of the work comes; the rest is writing."""

    reconstructed: float
    tracked: float
    measured: float


def work_shares(study: ContourStudy, options: Options) -> WorkShares:
    """Of an admitted study: over many frames, that go on from each other, measuring is a large
    part; over one it is a small one.
    """
    frames = sum(1 for frame in study.frames if frame_surfaces(frame, options))
    reconstructed = effort(study, options)
    tracked = reconstructed + TRACKING_COST * frames * options.tracked_meshes
    measured = tracked + MEASURING_COST * frames
    whole = measured + WRITING_COST * frames
    return WorkShares(reconstructed / whole, tracked / whole, measured / whole)
