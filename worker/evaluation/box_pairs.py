"""Which triangles can meet at all: those whose boxes along the axes overlap."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

Triangles = Float[np.ndarray, "m 3 3"]
"""Corner positions of triangles, mm."""

SomeTriangles = Float[np.ndarray, "_ 3 3"]
"""Triangles where a function speaks of several sets, of different counts."""

Pairs = Int[np.ndarray, "k 2"]
"""Index into one set, index into another."""

SomePairs = Int[np.ndarray, "_ 2"]
"""Pairs where a function speaks of several sets, of different counts."""

BLOCK = 2048
"""Boxes looked up at once: 2048 pairs for each box of the other set are held at most, even when
every box overlaps every other."""


class _Boxes(NamedTuple):
    """middles_mm, halves_mm: (m, 3), the middle and half the width of each box."""

    middles_mm: Float[np.ndarray, "m 3"]
    halves_mm: Float[np.ndarray, "m 3"]


def pairs_within(triangles_mm: Triangles) -> Iterator[Pairs]:
    """Pairs of triangles of one set, lower index first, whose boxes overlap or, to rounding, touch.

    Each pair once, in blocks and in no order.
    """
    boxes = _boxes(triangles_mm)
    for pairs in _near(boxes, boxes):
        yield _overlapping(pairs[pairs[:, 0] < pairs[:, 1]], boxes, boxes)


def pairs_between(one_mm: SomeTriangles, other_mm: SomeTriangles) -> Iterator[Pairs]:
    """Pairs (triangle of one, triangle of other) whose boxes overlap or, to rounding, touch.

    Each pair once, in blocks and in no order.
    """
    one, other = _boxes(one_mm), _boxes(other_mm)
    for pairs in _near(one, other):
        yield _overlapping(pairs, one, other)


def _boxes(triangles_mm: Triangles) -> _Boxes:
    low, high = triangles_mm.min(axis=1), triangles_mm.max(axis=1)
    return _Boxes((low + high) / 2.0, (high - low) / 2.0)


def _near(one: _Boxes, other: _Boxes) -> Iterator[Pairs]:
    """Pairs whose middles are no further apart along any axis than the reach of both.

    Reach is that of a box's size class: a few large boxes do not widen the search around the many
    small ones.
    """
    others = [
        (members, cKDTree(other.middles_mm[members]), other.halves_mm[members].max())
        for members in _size_classes(other)
    ]
    for members in _size_classes(one):
        # In the order of a tree's leaves, a block is a patch of neighbours.
        patches = members[cKDTree(one.middles_mm[members]).indices]
        for block in np.split(patches, range(BLOCK, len(patches), BLOCK)):
            tree, reach = cKDTree(one.middles_mm[block]), one.halves_mm[block].max()
            for other_members, other_tree, other_reach in others:
                near = tree.sparse_distance_matrix(
                    other_tree, reach + other_reach, p=np.inf, output_type="ndarray"
                )
                yield np.column_stack([block[near["i"]], other_members[near["j"]]])


def _size_classes(boxes: _Boxes) -> list[Int[np.ndarray, " _"]]:
    """Indices of boxes whose longest sides differ by no more than a factor of sixteen."""
    classes = np.frexp(boxes.halves_mm.max(axis=1))[1] // 4
    return [np.flatnonzero(classes == one) for one in np.unique(classes)]


def _overlapping(pairs: SomePairs, one: _Boxes, other: _Boxes) -> SomePairs:
    for axis in range(3):
        i, j = pairs.T
        apart = np.abs(one.middles_mm[i, axis] - other.middles_mm[j, axis])
        pairs = pairs[apart <= one.halves_mm[i, axis] + other.halves_mm[j, axis]]
    return pairs
