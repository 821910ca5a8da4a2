"""One shift a slice for all frames: a slice is one breath-hold, however many instants it shows.

Crossings of all frames are joined. They are not as many witnesses as they are points: a long-axis
slice that lies wrong does so in every frame. How alike the errors of one crossing are from frame to
frame is measured, and all crossings weigh less by as much (design effect; Kish 1965).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from schemas.vocabulary import View
from worker.reconstruction.crossings import (
    Crossings,
    crossings_of,
    evidence_of,
    misses,
    solved_shift,
)
from worker.reconstruction.motion import SliceMotion
from worker.reconstruction.shift_evidence import ShiftEvidence, no_evidence, prior_precision
from worker.reconstruction.unit_stack import UnitSlice, UnitStack

_SAME_PLANE = 0.01
"""Unit lengths, and sine of an angle, within which two planes are one."""

_TELLING = 20.0
"""Squared departure of one frame's shift in its standard deviations (two degrees of freedom) that
chance gives one frame in twenty thousand."""


@dataclass(frozen=True, eq=False)
class Disagreement:
    """A slice that some frames place elsewhere than all together: by `furthest`, unit lengths."""

    slice_id: str
    frames: tuple[int, ...]
    furthest: float


@dataclass(frozen=True, eq=False)
class SharedShifts:
    """What all frames say of the slices' shifts.

    slices: one of each id, the ids in order; evidence: in that order. dependence: by how much the
    crossings of all frames are fewer witnesses than points, 1 (independent) to the count of frames.
    """

    slices: tuple[UnitSlice, ...]
    evidence: ShiftEvidence
    dependence: float
    disagreements: tuple[Disagreement, ...]

    def of(self, stack: UnitStack) -> ShiftEvidence:
        """For the slices of one frame."""
        places = {one.id: place for place, one in enumerate(self.slices)}
        rows = np.array([places[one.id] for one in stack.slices])
        return replace(
            self.evidence,
            motion=self.evidence.motion[rows],
            precision=self.evidence.precision[rows],
            crossings=self.evidence.crossings[rows],
            settled=self.evidence.settled[rows],
        )

    def motion_of(self, stack: UnitStack) -> SliceMotion:
        """Of the slices of one frame, those that it shows nothing on too."""
        shifts = [
            motion[:2] @ one.axes if one.view is View.SAX else np.zeros(3)
            for one, motion in zip(stack.slices, self.of(stack).motion, strict=True)
        ]
        pivots = [one.lift(one.pivot[None])[0] for one in stack.slices]
        return SliceMotion(np.array(shifts), np.zeros(len(shifts)), np.array(pivots))

    def found(self, stack: UnitStack, shifts: Float[np.ndarray, "slices 3"]) -> "SharedShifts":
        """With the shifts (unit lengths) that a fit to one frame's stack found, for good.

        A slice that this frame shows nothing on stays where the evidence has it.
        """
        motion = self.evidence.motion.copy()
        places = {one.id: place for place, one in enumerate(self.slices)}
        for one, shift in zip(stack.slices, shifts, strict=True):
            if one.outlines:
                motion[places[one.id], :2] = one.axes @ shift
        return replace(self, evidence=replace(self.evidence, motion=motion, final=True))


def share_planes(stacks: Sequence[UnitStack]) -> bool:
    """Whether slices of one id lie in one plane in all stacks."""
    first: dict[str, UnitSlice] = {}
    return all(
        _is_same_plane(first.setdefault(one.id, one), one)
        for stack in stacks
        for one in stack.slices
    )


def shared_shifts(stacks: Sequence[UnitStack], prior: float, noise: float) -> SharedShifts | None:
    """From the crossings of all frames' stacks in one unit frame; None where nothing crosses.

    prior, noise: as of `crossing_evidence`. The stacks share their planes.
    """
    slices: dict[str, UnitSlice] = {}
    by_frame = [
        {one.id: [_in_order(c) for c in crossings_of(stack, one)] for one in stack.slices}
        for stack in stacks
    ]
    for stack in stacks:
        for one in stack.slices:
            slices.setdefault(one.id, one)
    joined = [[c for frame in by_frame for c in frame.get(name, ())] for name in slices]
    if not any(joined):
        return None
    alike = evidence_of(joined, prior, noise)
    dependence = _dependence(by_frame, dict(zip(slices, alike.motion[:, :2], strict=True)))
    evidence = evidence_of(joined, prior, noise, weight=1.0 / dependence)
    disagreements = _disagreements(by_frame, list(slices), evidence, prior, noise)
    return SharedShifts(tuple(slices.values()), evidence, dependence, disagreements)


def shared_from(
    stacks: Sequence[UnitStack], of_first: ShiftEvidence, first: int, prior: float
) -> SharedShifts:
    """From one frame alone, where nothing crosses: how its centroids stray is told by the anatomy
    that all frames share, so more frames say no more.
    """
    slices: dict[str, UnitSlice] = {}
    for stack in (stacks[first], *stacks):
        for one in stack.slices:
            slices.setdefault(one.id, one)
    known, unknown = len(stacks[first].slices), no_evidence(len(slices), prior)
    evidence = replace(
        of_first,
        motion=np.concatenate([of_first.motion, unknown.motion[known:]]),
        precision=np.concatenate([of_first.precision, unknown.precision[known:]]),
        crossings=np.concatenate([of_first.crossings, unknown.crossings[known:]]),
        settled=np.concatenate([of_first.settled, unknown.settled[known:]]),
    )
    return SharedShifts(tuple(slices.values()), evidence, 1.0, ())


def _is_same_plane(one: UnitSlice, other: UnitSlice) -> bool:
    turned = np.abs(one.axes - other.axes).max()
    return one.view is other.view and bool(
        max(turned, np.abs(one.origin - other.origin).max()) < _SAME_PLANE
    )


def _in_order(one: Crossings) -> Crossings:
    """With the points by their angle about the pivot, as in every other frame."""
    order = np.argsort(np.arctan2(one.points[:, 1], one.points[:, 0]), kind="stable")
    return replace(one, points=one.points[order], steepness=one.steepness[order])


def _dependence(
    by_frame: Sequence[dict[str, list[Crossings]]],
    shifts: dict[str, Float[np.ndarray, "2"]],
) -> float:
    """1 + (frames - 1) times the intraclass correlation of what the same crossing is missed by."""
    between = within = 0.0
    groups = spread = points_seen = rows_seen = 0
    for name, shift in shifts.items():
        table = _alike([frame.get(name, []) for frame in by_frame], shift)
        if table is None:
            continue
        frames, points = table.shape
        means = table.mean(axis=0)
        between += frames * float((means**2).sum())
        within += float(((table - means) ** 2).sum())
        # The slice's own shift has taken up two degrees of freedom.
        groups += max(points - 2, 0)
        spread += points * (frames - 1)
        points_seen += points
        rows_seen += points * frames
    if groups == 0 or between == 0.0:
        return 1.0
    of_means, of_frames = between / groups, within / spread
    frames_seen = rows_seen / points_seen
    variance = of_frames + max(of_means - of_frames, 0.0) / frames_seen
    return float(np.clip(of_means / variance, 1.0, frames_seen))


def _alike(
    by_frame: Sequence[list[Crossings]], shift: Float[np.ndarray, "2"]
) -> Float[np.ndarray, "frames points"] | None:
    """Misses of those frames that have as many crossings of the slice as most of them."""
    rows = [
        np.concatenate([misses(one, shift) for one in crossings])
        for crossings in by_frame
        if crossings
    ]
    if len(rows) < 2:
        return None
    counts = [len(row) for row in rows]
    usual = max(set(counts), key=counts.count)
    table = np.array([row for row in rows if len(row) == usual])
    table = table[:, ~np.isnan(table).any(axis=0)]
    return table if table.size and len(table) > 1 else None


def _disagreements(
    by_frame: Sequence[dict[str, list[Crossings]]],
    names: Sequence[str],
    evidence: ShiftEvidence,
    prior: float,
    noise: float,
) -> tuple[Disagreement, ...]:
    held = prior_precision(prior, turning=False)
    unsteady = max(noise, evidence.contour_noise or 0.0)
    found = []
    for name, shared in zip(names, evidence.motion[:, :2], strict=True):
        away = {}
        for index, frame in enumerate(by_frame):
            own = solved_shift(frame.get(name, []), held, unsteady)
            departure = own.motion[:2] - shared
            if departure @ own.precision[:2, :2] @ departure > _TELLING and len(own.residuals) > 2:
                away[index] = float(np.linalg.norm(departure))
        if away:
            found.append(Disagreement(name, tuple(away), max(away.values())))
    return tuple(found)
