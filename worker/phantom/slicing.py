"""Closed surfaces in, a contour study out: what a scanner and an observer would make of them."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from pydantic import ValidationError

from schemas.problem import InputError, ProblemType
from schemas.study import Contour, ContourStudy, Frame, Point, Slice
from schemas.vocabulary import Axes, Structure, Units, View
from worker.arrays import Points, Vector
from worker.evaluation.section import section
from worker.evaluation.topology import is_outward
from worker.phantom.long_axis import long_axis
from worker.phantom.outline import enclosed_mm2, evenly_spaced, unsteady
from worker.phantom.planes import SlicePlane, long_axis_planes, short_axis_stack
from worker.phantom.slicing_plan import STANDARD_PLAN, SlicingPlan
from worker.surface_mesh import SurfaceMesh

_LEAST_MM2 = 1.0
"""A loop smaller than this is a touch of the plane that nobody would outline."""

NO_TIMES: Mapping[str, float] = MappingProxyType({})
"""Of frames whose instants are not known."""


@dataclass(frozen=True, eq=False)
class SlicedStudy:
    """A study, and by slice id the (3,) displacement in mm that was added to its contours."""

    study: ContourStudy
    true_shifts_mm: Mapping[str, Vector]


def slice_frames(
    frames: Mapping[str, Mapping[Structure, SurfaceMesh]],
    plan: SlicingPlan = STANDARD_PLAN,
    *,
    subject_id: str = "phantom",
    axes: Axes = Axes.LPS,
    times_ms: Mapping[str, float] = NO_TIMES,
) -> SlicedStudy:
    """Slices the closed surfaces of every frame (by its label) by the same planes.

    Planes and displacements are those of the scanner, hence shared by all frames; a frame leaves
    out the planes that lie beyond its own surfaces by more than the margin. A structure that a
    plane misses is `absent` there. Deterministic in plan.seed.
    times_ms: when a frame was, by its label; a frame that it lacks tells no time.
    Raises InputError when a surface is not closed, or a name is none (see `Name`).
    """
    if not frames or not all(frames.values()):
        raise InputError(ProblemType.INVALID_REQUEST, "Give at least one surface to slice.")
    for label, meshes in frames.items():
        for structure, mesh in meshes.items():
            _require_closed(mesh, f"{label} {structure.value}")
    direction = None if plan.axis is None else np.array(plan.axis)
    axis = long_axis(next(iter(frames.values())), direction)
    planes = short_axis_stack(frames.values(), axis, plan.spacing_mm, plan.margin_mm)
    planes += long_axis_planes(axis, plan.long_axis_planes)
    shift_seed, *hand_seeds = np.random.SeedSequence(plan.seed).spawn(1 + len(frames))
    shifts = _shifts(planes, plan.shift_sd_mm, np.random.default_rng(shift_seed))
    try:
        study = ContourStudy(
            subject_id=subject_id,
            units=Units.MM,
            axes=axes,
            frames=[
                Frame(
                    label=label,
                    time_ms=times_ms.get(label),
                    slices=_slices(meshes, planes, shifts, plan, np.random.default_rng(hand)),
                )
                for (label, meshes), hand in zip(frames.items(), hand_seeds, strict=True)
            ],
        )
    except ValidationError as error:
        first = error.errors()[0]
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"No study comes of this: {first['loc'][-1]}: {first['msg']}; change it, and slice "
            "again.",
        ) from error
    return SlicedStudy(study, shifts)


def slice_meshes(
    meshes: Mapping[Structure, SurfaceMesh],
    plan: SlicingPlan = STANDARD_PLAN,
    *,
    label: str = "ED",
    subject_id: str = "phantom",
    axes: Axes = Axes.LPS,
) -> SlicedStudy:
    """`slice_frames` for a single frame."""
    return slice_frames({label: meshes}, plan, subject_id=subject_id, axes=axes)


def _slices(
    meshes: Mapping[Structure, SurfaceMesh],
    planes: list[SlicePlane],
    shifts: Mapping[str, Vector],
    plan: SlicingPlan,
    generator: np.random.Generator,
) -> list[Slice]:
    """Of one frame."""
    cuts = (
        _slice(plane, meshes, shifts[plane.id], plan, generator)
        for plane in planes
        if _is_within_margin(plane, meshes, plan.margin_mm)
    )
    return [cut for cut in cuts if cut]


def _slice(
    plane: SlicePlane,
    meshes: Mapping[Structure, SurfaceMesh],
    shift_mm: Vector,
    plan: SlicingPlan,
    generator: np.random.Generator,
) -> Slice | None:
    """The slice of one plane; None when it would say nothing."""
    contours: list[Contour] = []
    absent: list[Structure] = []
    for structure, mesh in meshes.items():
        loops = section(mesh, plane.origin_mm, plane.normal)
        if not loops:
            absent.append(structure)
        for loop in loops:
            if enclosed_mm2(loop) < _LEAST_MM2:
                continue
            even = evenly_spaced(loop, plan.point_spacing_mm)
            drawn = unsteady(
                even, plane.normal, plan.noise_sd_mm, plan.noise_correlation_mm, generator
            )
            contours.append(Contour(structure=structure, points=_wire(drawn + shift_mm)))
    if not contours and not absent:
        return None
    return Slice(
        id=plane.id,
        view=plane.view,
        origin=_wire((plane.origin_mm + shift_mm)[None], 6)[0],
        normal=_wire(plane.normal[None], 9)[0],
        contours=contours,
        absent=absent,
    )


def _shifts(
    planes: list[SlicePlane], sd_mm: float, generator: np.random.Generator
) -> dict[str, Vector]:
    """In-plane displacements of the short-axis slices; long-axis slices stay."""
    shifts = {}
    for plane in planes:
        shift = np.zeros(3)
        if plane.view is View.SAX:
            shift = generator.normal(scale=sd_mm, size=3)
            # An isotropic normal vector without its through-plane part: sd_mm on both axes.
            shift -= plane.normal * (plane.normal @ shift)
        shifts[plane.id] = shift
    return shifts


def _is_within_margin(
    plane: SlicePlane, meshes: Mapping[Structure, SurfaceMesh], margin_mm: float
) -> bool:
    heights = np.concatenate(
        [(m.vertices_mm - plane.origin_mm) @ plane.normal for m in meshes.values()]
    )
    return bool(heights.min() <= margin_mm and heights.max() >= -margin_mm)


def _wire(points_mm: Points, decimals: int = 4) -> list[Point]:
    return [(x, y, z) for x, y, z in np.round(points_mm, decimals).tolist()]


def _require_closed(mesh: SurfaceMesh, name: str) -> None:
    if not is_outward(mesh):
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"The surface {name} is not closed and facing outward, so its sections are no closed "
            "contours; fill its holes, merge doubled vertices and unify its orientation.",
        )
