"""More fits of the same frame, to tell how far the first one is to be trusted.

Without each slice in turn, whose contours then show how far the surface is off where nothing was
observed; and with other seeds, whose spread shows where the slices leave the surface open.

A part of the pipeline: it joins stages that do not know each other.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from schemas.options import Options
from schemas.vocabulary import Structure
from worker.checkpoints import Checkpoint
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.field_problem import (
    FieldProblem,
    moved_stack,
    outline_points,
    posed,
    solved,
)
from worker.reconstruction.fit import FieldFit
from worker.reconstruction.frame_share import FrameShare
from worker.reconstruction.meshing import surfaces_of
from worker.reconstruction.motion import SliceMotion
from worker.reconstruction.normalisation import UnitFrame
from worker.reconstruction.sampling import level_radius
from worker.reconstruction.shift_evidence import no_evidence
from worker.reconstruction.unit_stack import UnitStack
from worker.surface_mesh import SurfaceMesh

_LEVELS_AGAIN, _ITERATIONS_AGAIN = 2 / 3, 3 / 4
"""Part of the levels, the last ones, and of their iterations, that a refit without a slice takes:
half of a fit in all, as `intake.effort` says.

It starts from the field that knew the slice, at the full learning rate, and forgets it: measured,
its errors are those of a fit from nothing. At a third of the rate it remembers the slice, and its
errors are about three quarters of those; at a tenth, a third.
"""

_COARSE_MM = 2.0
"""Finest cells of a surface that is measured against one slice's contours only."""

_FIT_SHARE = 0.9
"""Part of a refit's work that is the fit; the rest is meshing."""

_SEEDS = 2**31

Surfaces = Mapping[Structure, SurfaceMesh]


@dataclass(frozen=True, eq=False)
class FirstFit:
    """What the refits start from: the problem as posed, its solution, and where slices were."""

    problem: FieldProblem
    frame: UnitFrame
    fit: FieldFit
    motion: SliceMotion


def slices_to_hold_out(problem: FieldProblem) -> list[int]:
    """Indices of the slices that show one of the problem's surfaces, where there are two at least.

    One slice alone leaves nothing to fit to.
    """
    showing = [index for index, one in enumerate(problem.shown.slices) if one.outlines]
    return showing if len(showing) > 1 else []


def held_out(
    first: FirstFit, options: Options, observer: FrameShare, checkpoint: Checkpoint
) -> Mapping[str, Surfaces]:
    """By slice id, closed surfaces fitted without it, mm. Those that no other slice shows, or of
    which the field then encloses nothing, are left out.

    Slices stay where they were found to be. options: as fitted with. checkpoint: of the frame; each
    refit is kept in a part of it. Raises Cancelled when the observer asks to stop.
    """
    chosen = slices_to_hold_out(first.problem)
    again = _again(options)
    moved = moved_stack(first.problem.stack, first.motion)
    found = {}
    for count, index in enumerate(chosen):
        part = observer.part(count / len(chosen), (count + 1) / len(chosen))
        rest = UnitStack(tuple(s for i, s in enumerate(moved.slices) if i != index))
        problem = posed(rest, first.problem.classes, options.sampling)
        still = SliceShifts(problem.shown, no_evidence(len(rest.slices), 1.0), limit=1.0)
        fit = solved(
            problem,
            still,
            again,
            part.part(0.0, _FIT_SHARE),
            start=first.fit.field,
            checkpoint=checkpoint.of(f"without-{index}"),
        )
        meshing = part.part(_FIT_SHARE, 1.0)
        found[moved.slices[index].id] = surfaces_of(
            fit, problem, outline_points(rest), first.frame, again, meshing, may_be_empty=True
        ).meshes
    return found


def ensemble(
    problem: FieldProblem,
    frame: UnitFrame,
    shifts_of: Callable[[], SliceShifts],
    options: Options,
    observer: FrameShare,
    checkpoint: Checkpoint,
) -> tuple[Surfaces, ...]:
    """Closed surfaces, mm, of `options.ensemble` more fits with the seeds that follow.

    shifts_of: new shifts for every fit, that learn anew. checkpoint: of the frame; each fit is kept
    in a part of it. Raises Cancelled when asked to stop.
    """
    members = []
    for index in range(options.ensemble):
        part = observer.part(index / options.ensemble, (index + 1) / options.ensemble)
        seed = (options.seed + 1 + index) % _SEEDS
        own = options.model_copy(update={"seed": seed, "target_edge_mm": None})
        shifts = shifts_of()
        kept = checkpoint.of(f"seed-{seed}")
        fit = solved(problem, shifts, own, part.part(0.0, _FIT_SHARE), checkpoint=kept)
        touching = outline_points(moved_stack(problem.stack, shifts.found()))
        meshing = part.part(_FIT_SHARE, 1.0)
        members.append(
            surfaces_of(fit, problem, touching, frame, own, meshing, may_be_empty=True).meshes
        )
    return tuple(members)


def _again(options: Options) -> Options:
    """A shorter fit over the last levels of the same ladder, meshed coarsely."""
    levels = max(1, round(_LEVELS_AGAIN * options.levels))
    skipped = options.levels - levels
    first_radius = level_radius(skipped, options.levels, options.sampling)
    grid_mm = max(_COARSE_MM, options.mesh.grid_mm)
    return options.model_copy(
        update={
            "levels": levels,
            "iterations_per_level": max(1, round(_ITERATIONS_AGAIN * options.iterations_per_level)),
            "sampling": options.sampling.model_copy(update={"first_radius": first_radius}),
            "mesh": options.mesh.model_copy(update={"grid_mm": grid_mm}),
            "target_edge_mm": None,
        }
    )
