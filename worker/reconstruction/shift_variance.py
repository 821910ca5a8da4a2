"""How far slices are displaced and how unsteady outlines are: told apart by maximum likelihood.

Every crossing says by how much, along a normal, a slice misses what crosses it:
offset = normal . shift + error, with shift ~ N(0, displacement^2) along each axis, the same for
all crossings of a slice, and error ~ N(0, noise^2 / weight), each for itself. What the crossings of
a slice have in common is its shift; what they have not is the hand that drew them.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from worker.arrays import PlanePoints, Scalars

_TRIED = 80
"""Standard deviations tried of either kind, evenly in their logarithms: 6 % apart."""


@dataclass(frozen=True, eq=False)
class SliceOffsets:
    """Crossings of one slice: unit normals (n, 2), offsets (n,) along them, weights (n,)."""

    normals: PlanePoints
    offsets: Scalars
    weights: Scalars


@dataclass(frozen=True)
class ShiftVariance:
    """Standard deviations, and how much likelier (nats) they are than slices all in place."""

    noise: float
    displacement: float
    evidence: float


def shift_variance(
    slices: Sequence[SliceOffsets], least: float, most: float, *, least_noise: float = 0.0
) -> ShiftVariance:
    """The likeliest noise and displacement between `least` and `most`.

    least_noise: the displacement is judged as if outlines were no steadier than this. All zero
    where no slice is crossed. Lengths in the unit of the offsets.
    """
    count = sum(len(one.offsets) for one in slices)
    if count == 0:
        return ShiftVariance(0.0, 0.0, 0.0)
    tried = np.geomspace(least, most, _TRIED)
    noise = float(tried[_likelihoods(slices, tried, tried).max(axis=1).argmax()])
    judged = np.array([max(noise, least_noise)])
    still, moved = _likelihoods(slices, judged, np.zeros(1)), _likelihoods(slices, judged, tried)[0]
    evidence = float(moved.max() - still[0, 0])
    displacement = float(tried[moved.argmax()]) if evidence > 0.0 else 0.0
    return ShiftVariance(noise, displacement, max(evidence, 0.0))


def _likelihoods(
    slices: Sequence[SliceOffsets],
    noises: Float[np.ndarray, " noises"],
    displacements: Float[np.ndarray, " displacements"],
) -> Float[np.ndarray, "noises displacements"]:
    """Logarithms, up to a common constant.

    In the principal directions of what a slice's crossings hold, its shift has two independent
    components, held by `strengths` and drawn by `pulls`.
    """
    strengths, pulls = np.empty(0), np.empty(0)
    squares, count = 0.0, 0
    for one in slices:
        held = np.einsum("n,ni,nj->ij", one.weights, one.normals, one.normals)
        strength, directions = np.linalg.eigh(held)
        pull = directions.T @ (one.normals.T @ (one.weights * one.offsets))
        strengths = np.append(strengths, np.maximum(strength, 0.0))
        pulls = np.append(pulls, pull)
        squares += float(one.weights @ one.offsets**2)
        count += len(one.offsets)
    noise, displacement = noises[:, None, None], displacements[None, :, None]
    ratio = (displacement / noise) ** 2
    swollen = 1.0 + ratio * strengths
    common = (ratio * pulls**2 / swollen).sum(axis=2) - squares
    spread = np.log(swollen).sum(axis=2) + 2.0 * count * np.log(noises)[:, None]
    likelihoods: np.ndarray = 0.5 * (common / noises[:, None] ** 2 - spread)
    return likelihoods
