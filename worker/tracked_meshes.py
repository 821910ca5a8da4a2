"""The surfaces of a reconstruction tracked through its frames, where that was asked for."""

import numpy as np

from schemas.options import Options
from schemas.vocabulary import Structure
from worker.evaluation.distance import nearest_on_surface
from worker.evaluation.size import volume_ml
from worker.observer import Observer
from worker.part_of_whole import PartOfWhole
from worker.reconstruction.cycle import in_time
from worker.reconstruction.result import Reconstruction
from worker.remeshing.remeshing import remesh
from worker.surface_mesh import SurfaceMesh
from worker.tracking.tracked_surface import TrackedSurface
from worker.tracking.tracking import track

FEWEST_FRAMES = 3

_EDGE_MM = 2.0
"""Edges of the carried mesh where no `target_edge_mm` is given."""


def tracked_surfaces(
    reconstruction: Reconstruction, options: Options, observer: Observer
) -> tuple[dict[Structure, TrackedSurface], list[str]]:
    """Every surface that three frames or more have, through those frames, from that of the largest
    volume; and a warning for each that was asked for and has fewer. Closed surfaces.

    Raises InternalError for a surface that faces inward, Cancelled when asked to stop.
    """
    found: dict[Structure, TrackedSurface] = {}
    warnings: list[str] = []
    if not options.tracked_meshes:
        return found, warnings
    structures = list(dict.fromkeys(s for fit in reconstruction.frames for s in fit.surfaces))
    for number, structure in enumerate(structures):
        share = PartOfWhole(observer, number / len(structures), (number + 1) / len(structures))
        fits = [fit for fit in reconstruction.frames if structure in fit.surfaces]
        order = in_time([fit.time_ms for fit in fits])
        surfaces = [(fits[i].label, fits[i].surfaces[structure]) for i in order]
        if len(surfaces) < FEWEST_FRAMES:
            warnings.append(
                f"{structure} was not tracked: {len(surfaces)} frames have it, and "
                f"`tracked_meshes` needs {FEWEST_FRAMES}."
            )
            continue
        largest = int(np.argmax([volume_ml(mesh) for _, mesh in surfaces]))
        rest = _even(surfaces[largest][1], options, share)
        is_whole_cycle = options.sequence.whole_cycle
        found[structure] = track(rest, surfaces, largest, share, is_whole_cycle=is_whole_cycle)
    return found, warnings


def _even(mesh: SurfaceMesh, options: Options, observer: Observer) -> SurfaceMesh:
    if options.target_edge_mm is not None:
        return mesh
    vertices, faces = remesh(
        mesh.vertices_mm,
        mesh.faces,
        _EDGE_MM,
        lambda points_mm: nearest_on_surface(points_mm, mesh)[0],
        observer,
    )
    return SurfaceMesh(vertices, faces)
