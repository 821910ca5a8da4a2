"""The frames' own surfaces thinned out, once for every file that is made to be looked at."""

from collections.abc import Mapping

from schemas.job import Progress, Stage
from schemas.vocabulary import Structure
from worker.artifacts.measured import Measured, MeasuredFrame
from worker.artifacts.page.display_mesh import MOST_TRIANGLES, display_mesh
from worker.checkpoints import Checkpoints, Unkept
from worker.crew import Alone, Crew, Part
from worker.observer import Cancelled, Observer, Unobserved
from worker.surface_mesh import SurfaceMesh

DisplayMeshes = Mapping[str, Mapping[Structure, SurfaceMesh]]
"""By the frame's label."""


def display_meshes(
    measured: Measured, observer: Observer | None = None, crew: Crew | None = None
) -> DisplayMeshes:
    """Of each surface of each frame. crew: who thins the frames. Raises Cancelled."""
    parts = [Part(_thinned, (frame,)) for frame in measured.frames]
    found = (crew or Alone()).all_of(parts, observer or Unobserved(), Unkept())
    return {frame.label: meshes for frame, meshes in zip(measured.frames, found, strict=True)}


def _thinned(
    frame: MeasuredFrame, observer: Observer, _: Checkpoints
) -> Mapping[Structure, SurfaceMesh]:
    if observer.is_cancelled():
        raise Cancelled
    observer.advanced(Progress(stage=Stage.WRITING, frame=frame.label))
    return {
        structure: display_mesh(surface.mesh, MOST_TRIANGLES)
        for structure, surface in frame.surfaces.items()
    }
