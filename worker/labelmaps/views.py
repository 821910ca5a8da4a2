"""Whether the views of one subject lie in one world."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from schemas.problem import InputError, ProblemType
from schemas.vocabulary import View
from worker.arrays import Points, Vector
from worker.labelmaps.planes import PlaneStack
from worker.labelmaps.volume import Tissues


@dataclass(frozen=True, eq=False)
class Extent:
    """Where a view's labels are: their centre, RAS mm, and how far 95 % of them are from it."""

    centre_mm: Vector
    reach_mm: float


def labelled_extent(stack: PlaneStack, frames: list[Tissues]) -> Extent:
    """The extent of the labels of all frames; at least one voxel is labelled."""
    used = np.logical_or.reduce([frame > 0 for frame in frames])
    points_mm: Points = np.argwhere(used) @ stack.affine_mm[:3, :3].T + stack.affine_mm[:3, 3]
    centre = points_mm.mean(axis=0)
    return Extent(centre, float(np.percentile(np.linalg.norm(points_mm - centre, axis=1), 95.0)))


def check_same_place(extents: Mapping[View, Extent]) -> None:
    """Refuse views whose hearts are apart: every view cuts the same left ventricle.

    Raises:
        InputError: `MISMATCHED_VIEWS` when a view's labels are centred out of the reach of
            another's.
    """
    (first, reference), *others = extents.items()
    for view, extent in others:
        apart = float(np.linalg.norm(extent.centre_mm - reference.centre_mm))
        if apart > max(extent.reach_mm, reference.reach_mm):
            raise InputError(
                ProblemType.MISMATCHED_VIEWS,
                f"the labels of `{view}` are centred {apart:.0f} mm from those of `{first}`, so "
                "the two maps are not of one heart in one place. Remedy: keep each map's affine as "
                "the scanner gave it (not reset or centred), and send views of one examination.",
                pointer=view,
            )
