"""Where long-axis outlines pass a short-axis plane, and what that says of the slice's shift.

Both views show one heart, so a long-axis outline must pass the plane of a short-axis slice on that
slice's own outline of the same structure. Each crossing fixes the shift along the outline's normal;
a handful of them fix it whole, without any field. Long-axis slices are taken to lie right.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from schemas.vocabulary import View
from worker.arrays import Flags, PlanePoint, PlanePoints, Scalars, Vector
from worker.reconstruction.shift_evidence import ShiftEvidence, prior_precision, shift_deviations
from worker.reconstruction.shift_variance import SliceOffsets, shift_variance
from worker.reconstruction.unit_stack import UnitOutline, UnitSlice, UnitStack

_ROUNDS = 20
"""Gauss-Newton steps, at most: each finds the nearest points of the outline anew."""

_STILL = 1e-7
"""Unit lengths, and radians: a step no longer than this is the last."""

_OUTLIER = 3.0
"""Residuals beyond so many noise levels count less and less (Huber)."""

_TELLING = 6.0
"""Nats by which displaced slices must explain the crossings better than slices in place, before any
moves: odds of four hundred to one."""

_SETTLED = 2.0
"""In outline noises: shifts known as well as this are not learned, which would only shake them."""

_FAR = 1e6
"""Unit lengths: where no point is."""

_TANGENT_EDGES = 3
"""Edges either way over which the direction of an outline is taken."""


@dataclass(frozen=True, eq=False)
class Crossings:
    """Crossings of one structure in a slice's plane, and that slice's own edges of it, from the
    slice's pivot.

    steepness: how steeply the long-axis outline passes the plane, 0 (along it) to 1. loose: whether
    an edge's start, and its end, is the free end of an open outline.
    """

    points: PlanePoints
    steepness: Scalars
    starts: Float[np.ndarray, "edges 2"]
    ends: Float[np.ndarray, "edges 2"]
    loose: Bool[np.ndarray, "edges 2"]


@dataclass(frozen=True, eq=False)
class ShiftSolution:
    """The most probable motion of one slice, and its inverse covariance, the prior included.

    residuals: misses that are left, across the long-axis outline. offsets: the same as seen
    before any shift, those that are out of line weighing less.
    """

    motion: Vector
    precision: Float[np.ndarray, "3 3"]
    residuals: Scalars
    offsets: SliceOffsets


def crossing_evidence(
    stack: UnitStack, prior: float, noise: float, *, turning: bool = False
) -> ShiftEvidence:
    """Shifts of the short-axis slices of a stack, from crossings.

    prior: standard deviation of a shift along each direction, at most. Where crossings show how far
    the slices of this stack are displaced, that is what the others are expected to be; where slices
    in place explain them nearly as well, none moves. noise: of an outline, at least; what crossings
    are found to disagree by is taken where it is larger. Unit lengths. turning: whether slices
    turn, too.
    """
    found = [crossings_of(stack, s) for s in stack.slices]
    return evidence_of(found, prior, noise, turning=turning)


def evidence_of(
    found: Sequence[Sequence[Crossings]],
    prior: float,
    noise: float,
    *,
    turning: bool = False,
    weight: float = 1.0,
) -> ShiftEvidence:
    """The same, from the crossings of every slice; those that stay have none.

    weight: of a crossing, beside one whose error is independent of all others'.
    """
    free = prior_precision(prior, turning)
    solved = [solved_shift(crossings, free, noise, weight) for crossings in found]
    usual = max(noise, _usual_miss(solved, prior))
    solved = [solved_shift(crossings, free, usual, weight) for crossings in found]
    spread = shift_variance(
        [solution.offsets for solution in solved], noise / 20.0, 4.0 * prior, least_noise=noise
    )
    unsteady = max(noise, spread.noise)
    crossed = any(crossings for crossings in found)
    expected = min(max(noise, spread.displacement), prior) if crossed else prior
    held = prior_precision(expected, turning)
    solved = [solved_shift(crossings, held, unsteady, weight) for crossings in found]
    displaced = weight * spread.evidence > _TELLING
    precision = np.array([s.precision for s in solved]).reshape(len(found), 3, 3)
    motion = np.array([s.motion for s in solved]).reshape(len(found), 3)
    return ShiftEvidence(
        motion=motion if displaced else np.zeros_like(motion),
        precision=precision,
        crossings=np.array([len(s.residuals) for s in solved], dtype=np.int64),
        settled=shift_deviations(precision) <= _SETTLED * noise,
        displaced=displaced,
        contour_noise=spread.noise if crossed else None,
    )


def crossings_of(stack: UnitStack, slice_: UnitSlice) -> list[Crossings]:
    """Of a short-axis slice with the stack's long-axis ones, structure by structure; else none."""
    found: list[Crossings] = []
    if slice_.view is not View.SAX:
        return found
    for structure, own in slice_.outlines.items():
        passes = [
            _passes(other, outline, slice_)
            for other in stack.slices
            if other.view.is_long_axis
            for outline in other.outlines.get(structure, ())
        ]
        points = np.concatenate([p for p, _ in passes]) if passes else np.empty((0, 2))
        if len(points):
            steepness = np.concatenate([s for _, s in passes])
            starts, ends = zip(*(outline.edges for outline in own), strict=True)
            rings = (points, np.concatenate(starts), np.concatenate(ends))
            points, start, end = (ring - slice_.pivot for ring in rings)
            loose = np.concatenate([_loose_ends(outline) for outline in own])
            found.append(Crossings(points, steepness, start, end, loose))
    return found


def _loose_ends(outline: UnitOutline) -> Bool[np.ndarray, "edges 2"]:
    loose = np.zeros((len(outline.edges[0]), 2), dtype=bool)
    if not outline.closed:
        loose[0, 0] = loose[-1, 1] = True
    return loose


def _passes(
    other: UnitSlice, outline: UnitOutline, slice_: UnitSlice
) -> tuple[np.ndarray, np.ndarray]:
    """Points (m, 2) in the slice's plane where the outline of another passes it; steepness (m,)."""
    starts, ends = (other.lift(edge) for edge in outline.edges)
    below, above = ((edge - slice_.origin) @ slice_.normal for edge in (starts, ends))
    through = np.flatnonzero((below > 0.0) != (above > 0.0))
    t = (below / np.where(below == above, 1.0, below - above))[through, None]
    edges = ends - starts
    around = through[:, None] + np.arange(-_TANGENT_EDGES, _TANGENT_EDGES + 1)
    around = around % len(edges) if outline.closed else np.clip(around, 0, len(edges) - 1)
    along = edges[around].sum(axis=1)
    lengths = np.linalg.norm(along, axis=1)
    steepness = np.abs(along @ slice_.normal) / np.where(lengths > 0.0, lengths, 1.0)
    return slice_.drop(starts[through] + t * edges[through]), steepness


def solved_shift(
    found: Sequence[Crossings],
    prior: Float[np.ndarray, "3 3"],
    noise: float,
    weight: float = 1.0,
) -> ShiftSolution:
    """The most probable motion: the slice's outlines, moved back by it, meet the crossings."""
    motion, precision = np.zeros(3), prior
    if not found:
        nothing = SliceOffsets(np.empty((0, 2)), np.empty(0), np.empty(0))
        return ShiftSolution(motion, precision, np.empty(0), nothing)
    every = _joined(found)
    for _ in range(_ROUNDS):
        turn = _turn_by(motion[2])
        drawn = (every.points + motion[:2]) @ turn.T
        away, normals, drawn_there = _offsets(drawn, every)
        doubt = np.maximum(1.0, np.abs(away) / (_OUTLIER * noise))
        weights = weight * drawn_there * every.steepness**2 / (noise**2 * doubt)
        by_turn = normals[:, 1] * drawn[:, 0] - normals[:, 0] * drawn[:, 1]
        slopes = np.column_stack([normals @ turn, by_turn])
        weighed = weights[:, None] * slopes
        precision = prior + weighed.T @ slopes
        step = np.linalg.solve(precision, away @ weighed - prior @ motion)
        before = away + slopes[:, :2] @ motion[:2]
        motion = motion + step
        if np.abs(step).max() < _STILL:
            break
    steady = (every.steepness / doubt) ** 2
    return ShiftSolution(
        motion,
        precision,
        (every.steepness * away)[drawn_there],
        SliceOffsets(slopes[drawn_there, :2], before[drawn_there], steady[drawn_there]),
    )


def _turn_by(angle: float) -> Float[np.ndarray, "2 2"]:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def _usual_miss(solved: Sequence[ShiftSolution], prior: float) -> float:
    """Standard deviation of the residuals, by their median: one wrong outline changes it little."""
    residuals = np.concatenate([solution.residuals for solution in solved])
    seen = sum(_shift_components_seen(solution, prior) for solution in solved)
    if len(residuals) == 0 or len(residuals) <= seen:
        return 0.0
    freedom = 1.0 - seen / len(residuals)
    return 1.4826 * float(np.median(np.abs(residuals))) / freedom**0.5


def _shift_components_seen(solution: ShiftSolution, prior: float) -> float:
    """How many of a shift's two components the crossings fix, beyond what the prior says."""
    covariance = np.linalg.inv(solution.precision)[:2, :2]
    return 2.0 - float(np.trace(covariance)) / prior**2


def misses(one: Crossings, shift: PlanePoint) -> Scalars:
    """What each point misses the outline by, across its own, once the slice is moved back by
    `shift`; NaN where the outline was not drawn.
    """
    away, _, drawn_there = _offsets(one.points + shift, _joined([one]))
    return np.where(drawn_there, one.steepness * away, np.nan)


@dataclass(frozen=True, eq=False)
class _Joined:
    """Points of many crossings, and beside each the edges that it may lie on, as many for each:
    those that fill up are far from everything.
    """

    points: PlanePoints
    steepness: Scalars
    starts: Float[np.ndarray, "n edges 2"]
    edges: Float[np.ndarray, "n edges 2"]
    squares: Float[np.ndarray, "n edges"]
    loose: Bool[np.ndarray, "n edges 2"]


def _joined(found: Sequence[Crossings]) -> _Joined:
    most = max(len(one.starts) for one in found)

    def filled(rows: np.ndarray, value: float = 0.0) -> np.ndarray:
        missing = most - len(rows)
        return np.pad(rows, ((0, missing), (0, 0)), constant_values=value) if missing else rows

    owner = np.repeat(np.arange(len(found)), [len(one.points) for one in found])
    edges = np.stack([filled(one.ends - one.starts) for one in found])
    return _Joined(
        points=np.concatenate([one.points for one in found]),
        steepness=np.concatenate([one.steepness for one in found]),
        starts=np.stack([filled(one.starts, _FAR) for one in found])[owner],
        edges=edges[owner],
        squares=np.maximum((edges**2).sum(axis=2), 1e-30)[owner],
        loose=np.stack([filled(one.loose) for one in found])[owner],
    )


def _offsets(points: PlanePoints, among: _Joined) -> tuple[Scalars, PlanePoints, Flags]:
    """Signed distances of points to the nearest edge along that edge's normal, and the normals.

    Last, whether the outline was drawn there: beyond the free end of an open one it says nothing.
    """
    x, y = (points[:, k, None] - among.starts[..., k] for k in (0, 1))
    along_x, along_y = among.edges[..., 0], among.edges[..., 1]
    t = np.clip((x * along_x + y * along_y) / among.squares, 0.0, 1.0)
    x, y = t * along_x - x, t * along_y - y
    nearest = np.arange(len(points)), (x**2 + y**2).argmin(axis=1)
    along = among.edges[nearest] / np.sqrt(among.squares[nearest])[:, None]
    normals = np.column_stack([along[:, 1], -along[:, 0]])
    loose = among.loose[nearest]
    beyond = loose[:, 0] & (t[nearest] <= 0.0) | loose[:, 1] & (t[nearest] >= 1.0)
    return x[nearest] * normals[:, 0] + y[nearest] * normals[:, 1], normals, ~beyond
