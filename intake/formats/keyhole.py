"""Keyhole contours: outline and hole drawn as one, joined by a channel without width.

One of the two ways of DICOM to leave a part out (PS3.3, C.8.8.6.3). The channel is no border of
the structure, so it is taken out and the parts become contours of their own.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SAME_MM = 1e-3
"""Points this close are the same place: coordinates are written with three decimals or more."""

MAX_HOLES = 32


def split_keyholes(points_mm: Array) -> list[Array]:
    """The closed outlines in one (n, 3), mm: itself alone where it has no channel.

    A channel is a run of edges that the outline walks there and, somewhere later, back.
    """
    whole, parts = [points_mm], list[Array]()
    while whole:
        ring = whole.pop()
        channel = _channel(ring) if len(whole) + len(parts) < MAX_HOLES else None
        if channel is None:
            parts.append(ring)
            continue
        turned, first, last, edges = channel
        ring = np.roll(ring, -turned, axis=0)
        whole.append(ring[first + edges : last - edges])
        whole.append(np.concatenate([ring[:first], ring[last:]]))
    return [ring for ring in parts if len(ring) >= 3]


def _channel(ring: Array) -> tuple[int, int, int, int] | None:
    """The longest channel: how far to turn the ring so that the channel does not cross its start;
    its outer end's two points, after that; and its edges.
    """
    count = len(ring)
    places = np.unique(np.round(ring / _SAME_MM).astype(np.int64), axis=0, return_inverse=True)[1]
    places = places.reshape(-1)
    order = np.argsort(places, kind="stable")
    same = np.flatnonzero(np.diff(places[order]) == 0)
    at = places.tolist()
    found: tuple[int, int, int, int] | None = None
    for one, other in zip(order[same].tolist(), order[same + 1].tolist(), strict=True):
        for i, j in ((one, other), (other, one + count)):
            if at[i - 1] == at[(j + 1) % count]:
                continue  # within a longer channel
            edges = 0
            while i + edges + 1 < j - edges - 1 and (
                at[(i + edges + 1) % count] == at[(j - edges - 1) % count]
            ):
                edges += 1
            # What the channel leads to, and what it comes from, must both be outlines.
            inner, outer = j - i - 2 * edges, count - (j - i)
            if edges and inner >= 3 and outer >= 3 and (found is None or edges > found[3]):
                found = (i, 0, j - i, edges)
    return found
