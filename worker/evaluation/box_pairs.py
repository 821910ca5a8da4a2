"""Which triangles can meet at all: those whose boxes along the axes overlap."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy import ndimage
from scipy.spatial import cKDTree

from worker.arrays import SomePoints

Triangles = Float[np.ndarray, "m 3 3"]
"""Corner positions of triangles, mm."""

SomeTriangles = Float[np.ndarray, "_ 3 3"]
"""Triangles where a function speaks of several sets, of different counts."""

Pairs = Int[np.ndarray, "k 2"]
"""Index into one set, index into another."""

SomePairs = Int[np.ndarray, "_ 2"]
"""Pairs where a function speaks of several sets, of different counts."""

Members = Int[np.ndarray, " _"]
"""Indices of some boxes of a set."""

BLOCK = 2048
"""Boxes looked up at once, where boxes are crowded: 2048 pairs for each box of the other set are
held at most, even when every box overlaps every other."""

AT_ONCE = 2**25
"""Pairs of one set that may be held at once: half a gigabyte. On a surface it is a tenth of it."""

_MOST_CELLS = 128
"""Of the lattice along its longest side."""

_BEYOND_ROUNDING = 1.0 + 1e-9
"""Of a reach: boxes that touch are not lost to the last digit."""


@dataclass(frozen=True, eq=False)
class _Boxes:
    """middles_mm: (m, 3). halves_mm: (m, 3), half the width of each box. reaches_mm: (m,), from
    the middle to a corner; a little more.

    Boxes overlap only where their middles are no further apart than the reach of both: fewer
    pairs are that near than pairs whose widest sides would let them be, and they are found sooner.
    """

    middles_mm: Float[np.ndarray, "m 3"]
    halves_mm: Float[np.ndarray, "m 3"]
    reaches_mm: Float[np.ndarray, " m"]


def pairs_within(triangles_mm: Triangles) -> Iterator[Pairs]:
    """Pairs of triangles of one set, lower index first, whose boxes overlap or, to rounding, touch.

    Each pair once, in blocks and in no order.
    """
    boxes = _boxes(triangles_mm)
    for pairs in _near_within(boxes):
        i, j = _overlapping(pairs, boxes, boxes).T
        yield np.column_stack([np.minimum(i, j), np.maximum(i, j)])


def pairs_between(one_mm: SomeTriangles, other_mm: SomeTriangles) -> Iterator[Pairs]:
    """Pairs (triangle of one, triangle of other) whose boxes overlap or, to rounding, touch.

    Each pair once, in blocks and in no order.
    """
    one, other = _boxes(one_mm), _boxes(other_mm)
    for members in _size_classes(one):
        for others in _size_classes(other):
            for pairs in _near_between(one, members, other, others):
                yield _overlapping(pairs, one, other)


def _boxes(triangles_mm: Triangles) -> _Boxes:
    # Axis by axis in memory: pairs are looked up along one axis after another.
    a, b, c = np.ascontiguousarray(np.moveaxis(triangles_mm, 0, 2)).swapaxes(1, 2)
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    halves = (high - low) / 2.0
    reaches = np.sqrt(np.einsum("md,md->m", halves, halves)) * _BEYOND_ROUNDING
    return _Boxes((low + high) / 2.0, halves, reaches)


def _near_within(boxes: _Boxes) -> Iterator[SomePairs]:
    """Pairs of one set whose middles are no further apart than the reach of both, each once."""
    classes = _size_classes(boxes)
    for number, members in enumerate(classes):
        crowded = _most_pairs(boxes, members) > AT_ONCE
        patches = _patches(boxes, members) if crowded else [members]
        for done, block in enumerate(patches):
            reach = 2.0 * boxes.reaches_mm[block].max()
            yield block[cKDTree(boxes.middles_mm[block]).query_pairs(reach, output_type="ndarray")]
            later = np.concatenate([members[:0], *patches[done + 1 :]])
            yield from _near_between(boxes, block, boxes, later)
        for others in classes[number + 1 :]:
            yield from _near_between(boxes, members, boxes, others)


def _most_pairs(boxes: _Boxes, members: Members) -> float:
    """No more pairs than this are near: a box has neighbours only in its own cell of a lattice as
    wide as the reach of two, and in the 26 around it. 0 where that reach is.
    """
    reach, middles = 2.0 * boxes.reaches_mm[members].max(), boxes.middles_mm[members]
    cells = np.floor((middles - middles.min(axis=0)) / reach) if reach > 0.0 else 0.0 * middles
    x, y, z = cells.T
    _, counts = np.unique(x + 2.0**17 * (y + 2.0**17 * z), return_counts=True)
    return 27.0 / 2.0 * float(np.sum(counts.astype(np.float64) ** 2))


def _near_between(
    one: _Boxes, members: Members, other: _Boxes, others: Members
) -> Iterator[SomePairs]:
    """Pairs (member of one, member of other) likewise."""
    if not len(members) or not len(others):
        return
    reach = other.reaches_mm[others].max()
    apart = one.reaches_mm[members].max() + reach
    members, others = _in_sight(one.middles_mm, members, other.middles_mm, others, apart)
    if not len(others):
        return
    tree = cKDTree(other.middles_mm[others])
    for block in _patches(one, members):
        near = cKDTree(one.middles_mm[block]).sparse_distance_matrix(
            tree, one.reaches_mm[block].max() + reach, output_type="ndarray"
        )
        yield np.column_stack([block[near["i"]], others[near["j"]]])


def _in_sight(
    one_mm: SomePoints, members: Members, other_mm: SomePoints, others: Members, apart_mm: float
) -> tuple[Members, Members]:
    """Members that may have one of the others no further than `apart_mm` away, and the others that
    may have such a member: those that lie in neighbouring cells of a coarse lattice.
    """
    here, there = one_mm[members], other_mm[others]
    low = np.minimum(here.min(axis=0), there.min(axis=0))
    high = np.maximum(here.max(axis=0), there.max(axis=0))
    width = max(apart_mm, float((high - low).max()) / _MOST_CELLS) * _BEYOND_ROUNDING or 1.0
    shape = tuple(int(n) + 1 for n in (high - low) // width)
    cells, other_cells = (((of - low) // width).astype(np.int64).T for of in (here, there))
    return (
        members[_beside(other_cells, shape)[tuple(cells)]],
        others[_beside(cells, shape)[tuple(other_cells)]],
    )


def _beside(cells: Int[np.ndarray, "3 _"], shape: tuple[int, ...]) -> np.ndarray:
    """Flags of a lattice: cells that are among these, or touch one of them."""
    taken = np.zeros(shape, dtype=bool)
    taken[tuple(cells)] = True
    return ndimage.binary_dilation(taken, np.ones((3, 3, 3), dtype=bool))


def _patches(boxes: _Boxes, members: Members) -> list[Members]:
    """Members in blocks of neighbours: in the order of a tree's leaves."""
    if len(members) <= BLOCK:
        return [members] if len(members) else []
    ordered = members[cKDTree(boxes.middles_mm[members]).indices]
    return np.split(ordered, range(BLOCK, len(ordered), BLOCK))


def _size_classes(boxes: _Boxes) -> list[Members]:
    """Indices of boxes by how far they reach, the furthest first, in steps of a factor of sixteen:
    a few large boxes do not widen the search around the many small ones. A few small ones go with
    the many that are larger.
    """
    reaches = boxes.reaches_mm
    largest = reaches.max(initial=0.0) or 1.0
    steps = (1 - np.frexp(reaches / largest)[1]) // 4
    classes: list[Members] = []
    for step in np.unique(steps):
        members = np.flatnonzero(steps == step)
        if classes and len(members) <= len(classes[-1]):
            classes[-1] = np.concatenate([classes[-1], members])
        else:
            classes.append(members)
    return classes


def _overlapping(pairs: SomePairs, one: _Boxes, other: _Boxes) -> SomePairs:
    i, j = pairs[:, 0], pairs[:, 1]
    for axis in range(3):
        middles, halves = one.middles_mm[:, axis].take(i), one.halves_mm[:, axis].take(i)
        middles -= other.middles_mm[:, axis].take(j)
        halves += other.halves_mm[:, axis].take(j)
        kept = np.flatnonzero(np.abs(middles, out=middles) <= halves)
        i, j = i.take(kept), j.take(kept)
    return np.column_stack([i, j])
