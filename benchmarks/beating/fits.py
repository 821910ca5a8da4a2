"""Reconstructions of a whole cycle in processes beside each other: surfaces, and their cost."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing import get_context

from schemas.options import Options
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.crew import Alone
from worker.observer import Unobserved
from worker.reconstruction.pipeline import reconstruct
from worker.surface_mesh import SurfaceMesh
from worker.threads import bind_libraries, use_threads
from worker.tracked_meshes import tracked_surfaces
from worker.tracking.tracked_surface import TrackedSurface

_PROCESSES = 2
_TOGETHER = 5
"""Frames from nothing in one task, at most: so the processes end at about the same time."""

_FROM_NOTHING = {"warm_start": False, "share_shifts": False}


@dataclass(frozen=True, eq=False)
class Fitted:
    """Surfaces by the frame's label. cpu_s: of the reconstruction, meshing included."""

    surfaces: Mapping[str, Mapping[Structure, SurfaceMesh]]
    cpu_s: float
    tracked: Mapping[Structure, TrackedSurface] = field(default_factory=dict)


def fitted(study: ContourStudy, options: Options) -> Fitted:
    """On one thread; its surfaces tracked where the options say so."""
    use_threads(1)
    used_s = time.process_time()
    found = reconstruct(study, options)
    cpu_s = time.process_time() - used_s
    tracked, _ = tracked_surfaces(found, options, Unobserved(), Alone())
    return Fitted({frame.label: frame.surfaces for frame in found.frames}, cpu_s, tracked)


def from_nothing(options: Options) -> Options:
    """Every frame by itself: no frame goes on from another, no slice shares its shift."""
    alone = options.sequence.model_copy(update=_FROM_NOTHING)
    return options.model_copy(update={"sequence": alone, "tracked_meshes": False})


def fitted_from_nothing(
    pool: Executor, study: ContourStudy, options: Options
) -> Callable[[], Fitted]:
    """Begin some frames a task; call what is returned for all of them."""
    alone = from_nothing(options)
    tasks: list[Future[Fitted]] = [pool.submit(fitted, part, alone) for part in _parts(study)]
    return lambda: _together(task.result() for task in tasks)


@contextmanager
def two_processes() -> Iterator[Executor]:
    """Of one thread each."""
    bind_libraries(1)
    with ProcessPoolExecutor(_PROCESSES, mp_context=get_context("spawn")) as pool:
        yield pool


def _parts(study: ContourStudy) -> Iterator[ContourStudy]:
    size = min(_TOGETHER, -(-len(study.frames) // _PROCESSES))
    for first in range(0, len(study.frames), size):
        yield study.model_copy(update={"frames": study.frames[first : first + size]})


def _together(parts: Iterable[Fitted]) -> Fitted:
    surfaces: dict[str, Mapping[Structure, SurfaceMesh]] = {}
    cpu_s = 0.0
    for part in parts:
        surfaces |= part.surfaces
        cpu_s += part.cpu_s
    return Fitted(surfaces, cpu_s)
