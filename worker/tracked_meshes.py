"""The surfaces of a reconstruction tracked through its frames, where that was asked for."""

from collections.abc import Sequence

import numpy as np

from schemas.cycle_report import FEWEST_FRAMES
from schemas.options import Options
from schemas.vocabulary import Structure
from worker.checkpoints import Checkpoints, Unkept
from worker.crew import Crew, Part
from worker.evaluation.distance import nearest_on_surface
from worker.evaluation.size import volume_ml
from worker.observer import Observer
from worker.reconstruction.cycle import after_largest_gap, in_time
from worker.reconstruction.result import FrameFit, Reconstruction
from worker.remeshing.remeshing import remesh
from worker.surface_mesh import SurfaceMesh
from worker.tracking.sound_mesh import sound_mesh
from worker.tracking.tracked_surface import TrackedSurface
from worker.tracking.tracking import track

_EDGES_MM = (2.0, 1.8, 1.6, 1.4)
"""Edges of the carried mesh where no `target_edge_mm` is given: the first that leave no triangle at
fault or soon to be. On a thin end other triangles, and smaller ones, lie better.
"""


def tracked_surfaces(
    reconstruction: Reconstruction, options: Options, observer: Observer, crew: Crew
) -> tuple[dict[Structure, TrackedSurface], list[str]]:
    """Every surface that three frames or more have, through those frames, from that of the largest
    volume; and a warning for each that was asked for and has fewer. Closed surfaces. Where the
    reconstruction was stopped early a mesh is carried to both ends of its frames, not round.

    Raises InternalError for a surface that faces inward, Cancelled when asked to stop.
    """
    parts: dict[Structure, Part] = {}
    warnings: list[str] = []
    is_whole_cycle = options.sequence.whole_cycle and not reconstruction.stopped_early
    if not options.tracked_meshes:
        return {}, warnings
    for structure in dict.fromkeys(s for fit in reconstruction.frames for s in fit.surfaces):
        fits = [fit for fit in reconstruction.frames if structure in fit.surfaces]
        order = _order(fits, reconstruction, options)
        surfaces = [(fits[i].label, fits[i].surfaces[structure]) for i in order]
        if len(surfaces) < FEWEST_FRAMES:
            warnings.append(
                f"{structure} was not tracked: {len(surfaces)} frames have it, and "
                f"`tracked_meshes` needs {FEWEST_FRAMES}."
            )
            continue
        parts[structure] = Part(_tracked, (surfaces, options, is_whole_cycle))
    found = crew.all_of(list(parts.values()), observer, Unkept())
    return dict(zip(parts, found, strict=True)), warnings


def _order(
    fits: Sequence[FrameFit], reconstruction: Reconstruction, options: Options
) -> Sequence[int]:
    """Indices in the order of time; of what is left of a whole cycle, from where most is missing
    on.
    """
    order = in_time([fit.time_ms for fit in fits])
    if not (reconstruction.stopped_early and options.sequence.whole_cycle):
        return order
    study = reconstruction.study_frames
    labels = [study[k].label for k in in_time([frame.time_ms for frame in study])]
    order = sorted(order, key=lambda k: labels.index(fits[k].label))
    first = after_largest_gap([labels.index(fits[k].label) for k in order], len(labels))
    return [*order[first:], *order[:first]]


def _tracked(
    surfaces: Sequence[tuple[str, SurfaceMesh]],
    options: Options,
    is_whole_cycle: bool,
    observer: Observer,
    _: Checkpoints,
) -> TrackedSurface:
    largest = int(np.argmax([volume_ml(mesh) for _, mesh in surfaces]))
    rest = _even(surfaces[largest][1], options, observer)
    return track(rest, surfaces, largest, observer, is_whole_cycle=is_whole_cycle)


def _even(mesh: SurfaceMesh, options: Options, observer: Observer) -> SurfaceMesh:
    """What is carried: sound, and with even triangles."""
    if options.target_edge_mm is not None:
        return sound_mesh(mesh, observer).mesh
    found = []
    for edge_mm in _EDGES_MM:
        vertices, faces = remesh(
            mesh.vertices_mm,
            mesh.faces,
            edge_mm,
            lambda points_mm: nearest_on_surface(points_mm, mesh)[0],
            observer,
        )
        found.append(sound_mesh(SurfaceMesh(vertices, faces), observer))
        if not found[-1].faults:
            break
    return min(found, key=lambda one: one.faults).mesh
