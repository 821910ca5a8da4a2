"""Points of one piece of an outline, put in order along it."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]

LONG_STEP = 4.0
"""Steps over the median distance to the nearest neighbour beyond which an outline has a gap."""

_FEW_GAPS = 4
_FEW_POINTS = 40
_MUCH_LONGER = 1.3
_NEIGHBOURS = 8
_MOST_TURNS = 900
"""Points looked at for a stretch to turn: what bounds the time that noise can take."""

_BLOCK = 512


def typical_step(points: Array) -> float:
    """Median distance of a point (n, 2) to its nearest neighbour; n >= 2, no repeats."""
    nearest = [
        np.sqrt(_squared(points, first).min(axis=1)) for first in range(0, len(points), _BLOCK)
    ]
    return float(np.median(np.concatenate(nearest)))


def in_order(points: Array) -> Index:
    """Order (n,) in which distinct points (n, 2) follow one another along their piece.

    As they stand where that makes few long steps, or, of few points, not a much longer way: the
    shortest way through a thin ring of few points is none around it. Else the shortest links first,
    then two links exchanged for two shorter ones while there are any: a curve is found again if it
    is sampled more closely than it comes near itself.
    """
    n = len(points)
    if n < 3:
        return np.arange(n)
    as_told = np.arange(n)
    if n < _FEW_POINTS:
        found = _uncrossed(points, _linked(points))
        is_short = _way(points) <= _MUCH_LONGER * _way(points[found])
        return as_told if is_short else found
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if int((steps > LONG_STEP * typical_step(points)).sum()) <= _FEW_GAPS:
        return as_told
    return _uncrossed(points, _linked(points))


def _way(points: Array) -> float:
    """Length of a path but for its longest step, which may be a gap."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return float(steps.sum() - steps.max())


def _neighbours(points: Array, count: int) -> tuple[Index, Array]:
    """Indices and distances (n, count) of the nearest others, in blocks of bounded memory."""
    count = min(count, len(points) - 1)
    index = np.empty((len(points), count), dtype=np.intp)
    length = np.empty((len(points), count))
    for first in range(0, len(points), _BLOCK):
        squared = _squared(points, first)
        near = np.argpartition(squared, count - 1, axis=1)[:, :count]
        index[first : first + _BLOCK] = near
        length[first : first + _BLOCK] = np.sqrt(np.take_along_axis(squared, near, axis=1))
    return index, length


def _squared(points: Array, first: int) -> Array:
    """Squared distances of a block of points from all, infinite from themselves."""
    block = points[first : first + _BLOCK]
    dx, dy = (block[:, None, k] - points[None, :, k] for k in (0, 1))
    squared: Array = dx * dx + dy * dy
    rows = np.arange(len(block))
    squared[rows, first + rows] = np.inf
    return squared


def _linked(points: Array) -> Index:
    """One path by the shortest links first, each point in at most two."""
    n = len(points)
    links: list[list[int]] = [[] for _ in range(n)]
    root = list(range(n))

    def find(i: int) -> int:
        while root[i] != i:
            root[i] = root[root[i]]
            i = root[i]
        return i

    def link(pairs: Index, lengths: Array) -> None:
        for k in np.argsort(lengths, kind="stable").tolist():
            a, b = int(pairs[k, 0]), int(pairs[k, 1])
            if len(links[a]) < 2 and len(links[b]) < 2 and find(a) != find(b):
                links[a].append(b)
                links[b].append(a)
                root[find(a)] = find(b)

    near, length = _neighbours(points, _NEIGHBOURS)
    a = np.repeat(np.arange(n), near.shape[1])
    link(np.stack([a, near.ravel()], axis=1), length.ravel())
    while True:
        ends = np.array([i for i in range(n) if len(links[i]) < 2])
        if len({find(int(i)) for i in ends}) == 1:
            break
        own, length = _neighbours(points[ends], len(ends) - 1 if len(ends) < 64 else 63)
        a = np.repeat(ends, own.shape[1])
        b = ends[own.ravel()]
        apart = np.array([find(int(i)) != find(int(j)) for i, j in zip(a, b, strict=True)])
        link(np.stack([a, b], axis=1)[apart], length.ravel()[apart])
    path = [int(ends[0])]
    before = -1
    while True:
        onward = [i for i in links[path[-1]] if i != before]
        if not onward:
            return np.array(path, dtype=np.intp)
        before = path[-1]
        path.append(onward[0])


def _uncrossed(points: Array, path: Index) -> Index:
    """The path with stretches turned round while that makes it shorter; its ends may move."""
    path = path.copy()
    idle = 0
    for _ in range(_MOST_TURNS // len(path)):
        path = path[::-1].copy()  # a turn moves the far end: each has to be the far one
        improved = False
        for i in range(len(path) - 1):
            p = points[path]
            # Turning path[i + 1 : j + 1] exchanges the links (i, i+1) and (j, j+1).
            ends = p[i + 1 :]
            step = np.linalg.norm(np.diff(ends, axis=0), axis=1)
            gain = np.linalg.norm(p[i] - p[i + 1]) - np.linalg.norm(p[i] - ends, axis=1)
            gain[:-1] += step - np.linalg.norm(p[i + 1] - ends[1:], axis=1)
            j = int(np.argmax(gain))
            if gain[j] > 1e-9 * (1.0 + float(step.sum())):
                path[i + 1 : i + 2 + j] = path[i + 1 : i + 2 + j][::-1].copy()
                improved = True
        idle = 0 if improved else idle + 1
        if idle == 2:
            break
    return path
