"""How far a surface is from the truth, as a whole and by region, in one pass over both."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks.results import Errors
from worker.arrays import Scalars, Vector
from worker.evaluation.distance import points_to_surface_mm
from worker.evaluation.surface_samples import area_uniform_samples_mm
from worker.evaluation.thirds import Region, Thirds
from worker.evaluation.topology import is_watertight
from worker.surface_mesh import SurfaceMesh

SAMPLES = 20_000
"""Points on either surface, uniform over its area; the same as `worker/evaluation/distance.py`."""


@dataclass(frozen=True, eq=False)
class _Directed:
    """Distances (n,) from samples of one surface to the other, and each sample's region (n,)."""

    distances_mm: Scalars
    region: np.ndarray


def errors(found: SurfaceMesh, truth: SurfaceMesh, parts: Thirds) -> dict[Region | None, Errors]:
    """Errors of a closed surface, under None those of the whole.

    Distances are exact, from points to triangles, both ways: mean and RMS over both directions,
    each weighing the same, the larger of both for the 95th percentile and the maximum. A sample
    belongs to the region where it lies. Volumes are those between the planes; an open surface has
    none.
    """
    generator = np.random.default_rng(0)
    there = _directed(found, truth, parts, generator)
    back = _directed(truth, found, parts, generator)
    off = _percent_off(found, truth, parts)
    whole = _errors(there.distances_mm, back.distances_mm, off[None])
    by_region: dict[Region | None, Errors] = {
        region: _errors(
            there.distances_mm[there.region == i],
            back.distances_mm[back.region == i],
            off[region],
        )
        for i, region in enumerate(Region)
    }
    return {None: whole, **by_region}


def residual_mm(
    found: Mapping[str, Vector], true: Mapping[str, Vector], slice_ids: frozenset[str]
) -> float:
    """RMS over slices of the length of what is left of the displacement, mm.

    A shift that was not looked for counts as zero: with none found this is the RMS displacement.
    """
    still = np.zeros(3)
    left = [found.get(i, still) - true.get(i, still) for i in sorted(slice_ids)]
    return float(np.sqrt(np.mean(np.sum(np.square(left), axis=1))))


def _directed(
    source: SurfaceMesh, target: SurfaceMesh, parts: Thirds, generator: np.random.Generator
) -> _Directed:
    samples = area_uniform_samples_mm(source, SAMPLES, generator)
    return _Directed(points_to_surface_mm(samples, target), parts.of(samples))


def _percent_off(
    found: SurfaceMesh, truth: SurfaceMesh, parts: Thirds
) -> dict[Region | None, float | None]:
    if not is_watertight(found):
        return dict.fromkeys([None, *Region])
    own, true = parts.volumes_ml(found), parts.volumes_ml(truth)
    whole = own.sum() / true.sum()
    ratios = dict(zip([None, *Region], [whole, *(own / true)], strict=True))
    return {region: 100.0 * (float(ratio) - 1.0) for region, ratio in ratios.items()}


def _errors(there: Scalars, back: Scalars, volume_error_percent: float | None) -> Errors:
    """A surface that does not reach a region has only the way back there."""
    ways = [way for way in (there, back) if len(way)]
    return Errors(
        mean_mm=float(np.mean([way.mean() for way in ways])),
        rms_mm=float(np.sqrt(np.mean([np.mean(way**2) for way in ways]))),
        p95_mm=max(float(np.percentile(way, 95.0)) for way in ways),
        max_mm=max(float(way.max()) for way in ways),
        volume_error_percent=volume_error_percent,
    )
