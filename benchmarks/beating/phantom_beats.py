"""Phantoms whose every point has a known path: how near a tracked mesh comes to it."""

from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from benchmarks.beating.fits import fitted, two_processes
from benchmarks.beating.paths import path_errors, true_paths
from benchmarks.beating.results import PhantomBeats, PhantomSurface
from benchmarks.beating.tracked_row import tracked_row
from benchmarks.environment import environment
from schemas.options import Options
from schemas.vocabulary import Structure
from worker.evaluation.area_share import vertex_areas_mm2
from worker.evaluation.distance import nearest_on_surface
from worker.evaluation.size import volume_ml
from worker.observer import Unobserved
from worker.phantom.beating import PRESETS, BeatingHeart, BeatPreset, SlicedBeat, sliced_beat
from worker.remeshing.remeshing import remesh
from worker.surface_mesh import SurfaceMesh
from worker.tracking.area_strain import area_strain
from worker.tracking.tracked_surface import TrackedSurface
from worker.tracking.tracking import track

FRAMES = 20
_EDGE_MM = 2.0
"""Of the mesh that is carried over the true surfaces, as `tracked_meshes` has it."""


class Tracked(StrEnum):
    """What the mesh was carried over."""

    TRUE = "true surfaces"
    RECONSTRUCTED = "reconstructed ones"


@dataclass(frozen=True, eq=False)
class PresetBeat:
    """A preset's heart, and its frames sliced by the standard plan."""

    heart: BeatingHeart
    beat: SlicedBeat


def phantom_beats(wanted: int | None = None, options: Options | None = None) -> PhantomBeats:
    """Every preset, tracked both over its true surfaces and over those reconstructed of its slices.

    wanted: frames of the beat, evenly over it.
    """
    where = environment()
    count, chosen = wanted or FRAMES, options or Options()
    with two_processes() as pool:
        tasks: list[Future[list[PhantomSurface]]] = [
            pool.submit(measured_beat, preset, tracked, count, chosen)
            for tracked in (Tracked.RECONSTRUCTED, Tracked.TRUE)
            for preset in BeatPreset
        ]
        surfaces = [surface for task in tasks for surface in task.result()]
    return PhantomBeats(environment=where, frames=count, surfaces=surfaces)


def measured_beat(
    preset: BeatPreset, tracked: Tracked, count: int, options: Options
) -> list[PhantomSurface]:
    """One row a surface."""
    case = PRESETS[preset]
    heart = BeatingHeart(case.shape, case.beat)
    beat = sliced_beat(heart, count)
    if tracked is Tracked.TRUE:
        found = {structure: track_true(beat, structure) for structure in beat.surfaces}
    else:
        asked = options.model_copy(update={"tracked_meshes": True})
        found = dict(fitted(beat.sliced.study, asked).tracked)
    volumes = true_volumes_ml(heart, beat)
    return [
        _row(PresetBeat(heart, beat), structure, one, volumes[structure], (preset, tracked))
        for structure, one in found.items()
    ]


def track_true(beat: SlicedBeat, structure: Structure) -> TrackedSurface:
    """An even mesh of end-diastole through the true surfaces of all frames. The tracker sees shapes
    only: it does not know which vertex of one frame is which of the next.
    """
    surfaces = [(label, frame[structure]) for label, frame in beat.frames().items()]
    first = surfaces[0][1]
    even = remesh(
        first.vertices_mm,
        first.faces,
        _EDGE_MM,
        lambda points_mm: nearest_on_surface(points_mm, first)[0],
        Unobserved(),
    )
    return track(SurfaceMesh(*even), surfaces, 0)


def true_volumes_ml(heart: BeatingHeart, beat: SlicedBeat) -> Mapping[Structure, list[float]]:
    """Exact ones of the left ventricle; of the right, of its mesh at end-diastole times exact
    shares.
    """
    right = beat.surfaces[Structure.RV_ENDO].frame(0)
    left = heart.lv_volumes_ml(beat.times_ms)
    return {
        **{structure: volumes.tolist() for structure, volumes in left.items()},
        Structure.RV_ENDO: (volume_ml(right) * heart.rv_shares(beat.times_ms)).tolist(),
    }


def _row(
    case: PresetBeat,
    structure: Structure,
    tracked: TrackedSurface,
    true_ml: list[float],
    names: tuple[BeatPreset, Tracked],
) -> PhantomSurface:
    at_rest, frames = tracked.mesh(0), range(len(tracked.vertices_mm))
    surface = case.beat.surfaces[structure].frame(0)
    paths = true_paths(case.heart, structure, surface, at_rest.vertices_mm, case.beat.times_ms)
    errors = path_errors(tracked.vertices_mm, paths.positions_mm, paths.normals)
    areas_mm2 = vertex_areas_mm2(at_rest)
    weights = areas_mm2 / areas_mm2.sum()
    true_strain, strain = paths.area_ratio - 1.0, area_strain(tracked, 0)
    preset, over = names
    return PhantomSurface(
        preset=preset,
        tracked=over,
        surface=structure,
        normal_mm=(errors.normal_mm @ weights).tolist(),
        tangential_mm=(errors.tangential_mm @ weights).tolist(),
        p95_mm=np.percentile(errors.length_mm, 95.0, axis=1).tolist(),
        true_strain_percent=(100.0 * true_strain @ weights).tolist(),
        strain_percent=(100.0 * strain @ weights).tolist(),
        strain_error_percent=(100.0 * np.abs(strain - true_strain) @ weights).tolist(),
        true_ml=true_ml,
        found_ml=[volume_ml(tracked.mesh(frame)) for frame in frames],
        mesh=tracked_row(tracked),
    )
