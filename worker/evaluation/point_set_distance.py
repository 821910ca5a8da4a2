"""Distances between two sets of points, as the method's paper measures them."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from schemas.problem import InternalError, ProblemType
from worker.arrays import SomePoints
from worker.evaluation.distance import DirectedDistance, directed


@dataclass(frozen=True)
class PointSetDistance:
    """Nearest-neighbour distances between two point sets P and Q, both ways.

    chamfer_mm2: mean squared distance from P to Q plus that from Q to P.
    rms_chamfer_mm: square root of half of it, a length again.
    hausdorff_mm: largest distance either way. hausdorff{50,90,95}_mm: the larger of the two
        directions' percentiles.
    rmse_mm, mae_mm: root mean square and mean of all distances, those of both directions together;
        so rmse_mm is never the smaller.
    optimal_threshold_mm: 90th percentile of the distances from P to Q, P the surface that is
        judged: what nine tenths of it are nearer than.
    to_reference, from_reference: the directed distances that all others are made of, from each of
        P to the nearest of Q, and from each of Q to the nearest of P.

    These do not vanish for two samplings of one surface: the floor is about half the spacing of
    the points. For judgement use `surface_to_surface`.
    Source: NeuralMRI (arXiv 2603.27003), whose Chamfer distance is squared.
    """

    chamfer_mm2: float
    rms_chamfer_mm: float
    hausdorff_mm: float
    hausdorff50_mm: float
    hausdorff90_mm: float
    hausdorff95_mm: float
    rmse_mm: float
    mae_mm: float
    optimal_threshold_mm: float
    to_reference: DirectedDistance
    from_reference: DirectedDistance


def point_set_distance(first_mm: SomePoints, second_mm: SomePoints) -> PointSetDistance:
    """Distances between point sets P (n, 3) and Q (m, 3), mm.

    Raises InternalError if one is empty.
    """
    if not len(first_mm) or not len(second_mm):
        raise InternalError(ProblemType.NO_SURFACE, "A point set without points has no distance.")
    there, _ = cKDTree(second_mm).query(first_mm)
    back, _ = cKDTree(first_mm).query(second_mm)
    either = np.concatenate([there, back])
    to_reference, from_reference = directed(there), directed(back)
    chamfer = to_reference.rms_mm**2 + from_reference.rms_mm**2
    return PointSetDistance(
        chamfer_mm2=chamfer,
        rms_chamfer_mm=float(np.sqrt(chamfer / 2.0)),
        hausdorff_mm=max(to_reference.max_mm, from_reference.max_mm),
        hausdorff50_mm=max(to_reference.p50_mm, from_reference.p50_mm),
        hausdorff90_mm=max(to_reference.p90_mm, from_reference.p90_mm),
        hausdorff95_mm=max(to_reference.p95_mm, from_reference.p95_mm),
        rmse_mm=float(np.sqrt(np.mean(either**2))),
        mae_mm=float(np.mean(either)),
        optimal_threshold_mm=to_reference.p90_mm,
        to_reference=to_reference,
        from_reference=from_reference,
    )
