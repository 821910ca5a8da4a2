"""Known surfaces of a real cycle, sliced and reconstructed: from each other, or from nothing."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.beating.fits import Fitted, fitted, fitted_from_nothing, two_processes
from benchmarks.beating.fitted_cycle import fitted_cycle
from benchmarks.beating.real_cycle import MODEL
from benchmarks.beating.results import SlicedCycle, SlicedSurface
from benchmarks.beating.spread_out import spread_out
from benchmarks.beating.tracked_row import tracked_row
from benchmarks.environment import environment
from schemas.options import Options
from schemas.vocabulary import Structure
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.size import volume_ml
from worker.phantom.slicing import slice_frames
from worker.surface_mesh import SurfaceMesh

Truth = Sequence[Mapping[Structure, SurfaceMesh]]


def sliced_cycle(
    data: Path, wanted: int | None = None, options: Options | None = None
) -> SlicedCycle:
    """data: the folder that has `MODEL`. wanted: frames, for a short run."""
    every = fitted_cycle(data / MODEL)
    truth = [every[k] for k in spread_out(len(every), wanted)]
    return sliced(truth, options or Options())


def sliced(truth: Truth, options: Options) -> SlicedCycle:
    """By the standard plan: short-axis slices 8 mm apart and three long-axis ones, in place."""
    where = environment()
    study = slice_frames({f"F{k:02d}": frame for k, frame in enumerate(truth)}).study
    with two_processes() as pool:
        whole = pool.submit(fitted, study, options.model_copy(update={"tracked_meshes": True}))
        rest = fitted_from_nothing(pool, study, options)
        warm, cold = whole.result(), rest()
    return SlicedCycle(
        environment=where,
        frames=len(truth),
        surfaces=[_surface(s, truth, warm, cold) for s in truth[0]],
        warm_cpu_s=warm.cpu_s,
        cold_cpu_s=cold.cpu_s,
    )


def _surface(structure: Structure, truth: Truth, warm: Fitted, cold: Fitted) -> SlicedSurface:
    true = [frame[structure] for frame in truth]
    by_warm, by_cold = _meshes(warm, structure), _meshes(cold, structure)
    tracked = warm.tracked[structure]
    carried = [tracked.mesh(frame) for frame in range(len(true))]
    return SlicedSurface(
        surface=structure,
        warm_mm=_distances_mm(by_warm, true),
        cold_mm=_distances_mm(by_cold, true),
        true_ml=[volume_ml(mesh) for mesh in true],
        warm_ml=[volume_ml(mesh) for mesh in by_warm],
        cold_ml=[volume_ml(mesh) for mesh in by_cold],
        tracked=tracked_row(tracked),
        tracked_mm=_distances_mm(carried, true),
    )


def _meshes(found: Fitted, structure: Structure) -> list[SurfaceMesh]:
    """In the order of labels, which is that of time."""
    return [found.surfaces[label][structure] for label in sorted(found.surfaces)]


def _distances_mm(found: Sequence[SurfaceMesh], true: Sequence[SurfaceMesh]) -> list[float]:
    # Strict: a frame that could not be reconstructed has no place in these means.
    return [surface_to_surface(one, other).mean_mm for one, other in zip(found, true, strict=True)]
