"""The meshes of a job as files, frame by frame: each frame's own, and those tracked through all."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float

from schemas.cycle_report import CycleReport
from schemas.job import Progress, Stage
from schemas.surface_name import SurfaceName
from schemas.vocabulary import Axes, MeshFormat
from worker.arrays import SomeScalars
from worker.artifacts.measured import Measured
from worker.artifacts.meshes import write_mesh
from worker.checkpoints import Checkpoints, Unkept
from worker.crew import Crew, Part
from worker.observer import Cancelled, Observer
from worker.surface_mesh import SurfaceMesh
from worker.tracking.area_strain import area_strain
from worker.tracking.tracked_surface import TrackedSurface


@dataclass(frozen=True, eq=False)
class _Named:
    """A mesh, what it is called inside its files, and what they are called. fields: at vertices."""

    mesh: SurfaceMesh
    name: str
    file_name: str
    fields: Mapping[str, SomeScalars] = field(default_factory=dict)


def write_meshes(
    measured: Measured,
    out_dir: Path,
    job_id: str | None,
    observer: Observer,
    crew: Crew,
) -> None:
    """Write every mesh in every format that was asked for. Raises Cancelled."""
    report = measured.report
    meshes: dict[str, list[_Named]] = {}
    for frame in measured.frames:
        for structure, surface in frame.surfaces.items():
            name = str(SurfaceName(frame.label, structure))
            named = _Named(surface.mesh, name, name, surface.fields)
            meshes.setdefault(frame.label, []).append(named)
    for structure, carried in measured.tracked.items():
        strain = _strain(carried, report.cycle)
        for index, at in enumerate(carried.frames):
            name = str(SurfaceName(at.label, structure))
            fields = {} if strain is None else {"area_strain": strain[index]}
            named = _Named(carried.mesh(index), name, f"{name}_tracked", fields)
            meshes.setdefault(at.label, []).append(named)
    formats = tuple(dict.fromkeys(report.options.formats))
    parts = [
        Part(_written, (label, some, formats, report.axes, out_dir, job_id))
        for label, some in meshes.items()
    ]
    crew.all_of(parts, observer, Unkept())


def _strain(
    carried: TrackedSurface, cycle: CycleReport | None
) -> Float[np.ndarray, "frames n"] | None:
    labels = [frame.label for frame in carried.frames]
    if cycle is None or cycle.ed_frame not in labels:
        return None
    return area_strain(carried, labels.index(cycle.ed_frame))


def _written(
    label: str,
    meshes: list[_Named],
    formats: tuple[MeshFormat, ...],
    axes: Axes,
    out_dir: Path,
    job_id: str | None,
    observer: Observer,
    _: Checkpoints,
) -> None:
    if observer.is_cancelled():
        raise Cancelled
    observer.advanced(Progress(stage=Stage.WRITING, frame=label))
    for one in meshes:
        for form in formats:
            path = out_dir / f"{one.file_name}.{form}"
            write_mesh(path, one.mesh, one.name, axes, one.fields, job_id=job_id)
