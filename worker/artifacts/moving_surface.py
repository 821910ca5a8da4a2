"""A surface as it moves: its mesh at every frame that has it."""

from collections.abc import Mapping
from dataclasses import dataclass

from schemas.cycle_report import FEWEST_FRAMES
from schemas.vocabulary import Structure
from worker.artifacts.frame_times import FrameTimes
from worker.artifacts.measured import Measured
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True, eq=False)
class MovingSurface:
    """frames: indices in `FrameTimes.labels`, rising. meshes: one each, mm. is_tracked: they have
    the same triangles, and a vertex is the same point of the tissue as far as that can be told.
    """

    structure: Structure
    frames: tuple[int, ...]
    meshes: tuple[SurfaceMesh, ...]
    is_tracked: bool


def moving_surfaces(measured: Measured, times: FrameTimes) -> list[MovingSurface]:
    """Every surface that three frames or more have: the tracked mesh where there is one, else the
    frames' own.
    """
    place = {label: index for index, label in enumerate(times.labels)}
    found: dict[Structure, dict[int, SurfaceMesh]] = {}
    for frame in measured.frames:
        for structure, surface in frame.surfaces.items():
            found.setdefault(structure, {})[place[frame.label]] = surface.mesh
    return [
        _tracked(measured, structure, place) or _of_frames(structure, meshes)
        for structure, meshes in found.items()
        if len(meshes) >= FEWEST_FRAMES
    ]


def _tracked(
    measured: Measured, structure: Structure, place: Mapping[str, int]
) -> MovingSurface | None:
    tracked = measured.tracked.get(structure)
    if tracked is None:
        return None
    # A frame that could not be measured has no place in the report.
    at = {place[f.label]: n for n, f in enumerate(tracked.frames) if f.label in place}
    meshes = tuple(tracked.mesh(at[frame]) for frame in sorted(at))
    return MovingSurface(structure, tuple(sorted(at)), meshes, is_tracked=True)


def _of_frames(structure: Structure, meshes: Mapping[int, SurfaceMesh]) -> MovingSurface:
    frames = tuple(sorted(meshes))
    return MovingSurface(structure, frames, tuple(meshes[f] for f in frames), is_tracked=False)
