"""Files that viewers play, of a subject with three frames or more."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from schemas.job import Progress, Stage
from schemas.options import Options
from schemas.surface_name import SurfaceName
from schemas.vocabulary import MeshFormat
from worker.artifacts.display_meshes import DisplayMeshes, display_meshes
from worker.artifacts.frame_times import FrameTimes, frame_times
from worker.artifacts.measured import Measured
from worker.artifacts.mesh_files.moving_glb import write_moving_glb
from worker.artifacts.mesh_files.pvd import write_pvd
from worker.artifacts.moving_surface import MovingSurface, moving_surfaces
from worker.observer import Cancelled, Observer, Unobserved
from worker.tracked_meshes import FEWEST_FRAMES

MOVING_GLB_NAME = "cycle.glb"
"""No mesh of a frame is called so: their names end in a surface."""


def write_playback(
    measured: Measured,
    options: Options,
    out_dir: Path,
    job_id: str | None = None,
    observer: Observer | None = None,
    thinned: DisplayMeshes | None = None,
) -> None:
    """With `vtp`, `{surface}.pvd` and `{surface}_tracked.pvd` beside the meshes that they name;
    with `glb`, `cycle.glb` with all surfaces. Nothing for fewer than three frames. thinned: where
    other files have them too. Raises Cancelled when the observer asks to stop.
    """
    times = frame_times(measured.report.frames, is_whole_cycle=options.sequence.whole_cycle)
    if len(times.labels) < FEWEST_FRAMES:
        return
    moving = moving_surfaces(measured, times)
    axes = measured.report.axes
    if MeshFormat.VTP in options.formats:
        for surface in moving:
            _write_collections(measured, times, surface, out_dir, job_id)
    if MeshFormat.GLB in options.formats and moving:
        if thinned is None:
            thinned = display_meshes(measured)
        drawn = _drawn(moving, times, thinned, observer or Unobserved())
        write_moving_glb(out_dir / MOVING_GLB_NAME, drawn, times, axes, job_id=job_id)


def _write_collections(
    measured: Measured,
    times: FrameTimes,
    surface: MovingSurface,
    out_dir: Path,
    job_id: str | None,
) -> None:
    structure = surface.structure
    having = {frame.label for frame in measured.frames if structure in frame.surfaces}
    endings = {"": having}
    if surface.is_tracked:
        endings["_tracked"] = {times.labels[place] for place in surface.frames}
    for ending, labels in endings.items():
        parts = [
            (step, f"{SurfaceName(label, structure)}{ending}.{MeshFormat.VTP}")
            for step, label in zip(times.steps, times.labels, strict=True)
            if label in labels
        ]
        name = f"{structure}{ending}"
        facts = {"units": "mm", "axes": measured.report.axes.value, "name": name}
        said = facts if job_id is None else facts | {"job_id": job_id}
        write_pvd(out_dir / f"{name}.pvd", parts, times.unit, said)


def _drawn(
    moving: Sequence[MovingSurface], times: FrameTimes, thinned: DisplayMeshes, observer: Observer
) -> Iterator[MovingSurface]:
    """Each as the viewers' file has it, once the one before is written."""
    for place, surface in enumerate(moving):
        if observer.is_cancelled():
            raise Cancelled
        observer.advanced(Progress(stage=Stage.WRITING, fraction=place / len(moving)))
        if surface.is_tracked:
            yield surface
        else:
            labels = [times.labels[frame] for frame in surface.frames]
            yield replace(
                surface, meshes=tuple(thinned[label][surface.structure] for label in labels)
            )
