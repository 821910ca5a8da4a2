"""A beat as it would be scanned: frames evenly over it, sliced, beside their truth."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from schemas.vocabulary import Axes, Structure
from worker.phantom.beating.beating_heart import BeatingHeart, MovingSurface
from worker.phantom.bounds import require_within
from worker.phantom.slicing import SlicedStudy, slice_frames
from worker.phantom.slicing_plan import STANDARD_PLAN, SlicingPlan
from worker.surface_mesh import SurfaceMesh

_MOST_FRAMES = 200


@dataclass(frozen=True, eq=False)
class SlicedBeat:
    """labels: of the frames, F00 (end-diastole) to the last. times_ms: (frames,). surfaces: the
    true ones, carried. sliced: the study cut from them, and its displacements.
    """

    labels: tuple[str, ...]
    times_ms: Float[np.ndarray, " frames"]
    surfaces: Mapping[Structure, MovingSurface]
    sliced: SlicedStudy

    def frames(self) -> Mapping[str, Mapping[Structure, SurfaceMesh]]:
        """The true surfaces of each frame."""
        return _frames(self.labels, self.surfaces)


def sliced_beat(
    heart: BeatingHeart,
    count: int,
    plan: SlicingPlan = STANDARD_PLAN,
    *,
    edge_mm: float = 1.0,
    subject_id: str = "phantom",
) -> SlicedBeat:
    """`count` frames of one beat, LPS, by the same planes and displacements in all of them.

    Raises InputError for a count, an edge or a name out of bounds.
    """
    require_within("frames", float(count), 1.0, float(_MOST_FRAMES))
    times_ms = heart.beat.cycle.frame_times_ms(count)
    digits = max(2, len(str(count - 1)))
    labels = tuple(f"F{i:0{digits}d}" for i in range(count))
    surfaces = heart.surfaces(times_ms, edge_mm)
    sliced = slice_frames(
        _frames(labels, surfaces),
        plan,
        subject_id=subject_id,
        axes=Axes.LPS,
        times_ms=dict(zip(labels, times_ms.tolist(), strict=True)),
    )
    return SlicedBeat(labels, times_ms, surfaces, sliced)


def _frames(
    labels: tuple[str, ...], surfaces: Mapping[Structure, MovingSurface]
) -> dict[str, dict[Structure, SurfaceMesh]]:
    return {
        label: {structure: moving.frame(i) for structure, moving in surfaces.items()}
        for i, label in enumerate(labels)
    }
