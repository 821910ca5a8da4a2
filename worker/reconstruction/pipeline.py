"""The whole way from a contour study to surfaces: the only file that knows every stage.

study -> stack (mm) -> unit stack + UnitFrame -> levels of samples -> tissue field -> isosurfaces ->
one component -> level-set projection -> mm -> closed or open base.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from intake.effort import REFIT_COST
from intake.support import frame_surfaces
from schemas.job import Stage
from schemas.options import Base, Holdout, Options
from schemas.problem import InputError, InternalError, ProblemType, ServiceError
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.checkpoints import Checkpoint, Checkpoints, Unkept
from worker.observer import Observer, Unobserved
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.base_plane import cut_open, find_base
from worker.reconstruction.cycle import FitStep
from worker.reconstruction.field_problem import (
    FieldProblem,
    moved_stack,
    outline_points,
    posed,
    solved,
)
from worker.reconstruction.fit import FieldFit
from worker.reconstruction.frame_share import FrameShare
from worker.reconstruction.meshing import curvature_of, finest_cell, surfaces_of
from worker.reconstruction.motion import SliceMotion
from worker.reconstruction.normalisation import UnitFrame, normalised, unit_frame_of
from worker.reconstruction.posed_frame import PosedFrame
from worker.reconstruction.refits import (
    FirstFit,
    ensemble,
    held_out,
    slices_to_hold_out,
)
from worker.reconstruction.result import (
    ContourPoints,
    FailedFrame,
    FrameFit,
    LevelFit,
    Reconstruction,
    SliceFit,
)
from worker.reconstruction.sampling import level_radius
from worker.reconstruction.sequence import FrameSequence, sequence_plan
from worker.reconstruction.shift_evidence import ShiftEvidence
from worker.reconstruction.slice_stack import SliceStack
from worker.reconstruction.stack_evidence import FURTHEST_SHIFT
from worker.reconstruction.stacking import build_stack
from worker.reconstruction.tempering import tempered
from worker.reconstruction.tissues import partition
from worker.reconstruction.unit_stack import UnitStack
from worker.reconstruction.warm_start import warm_options
from worker.reconstruction.workload import check_workload

_FIT_SHARE = 0.9
"""Part of a frame's work that is the fit; the rest is meshing."""

_OF_A_FRAME = (ProblemType.NO_SURFACE, ProblemType.INTERNAL)
"""Failures of ours that other frames of the study may well not share."""


def reconstruct(
    study: ContourStudy,
    options: Options,
    observer: Observer | None = None,
    checkpoints: Checkpoints | None = None,
) -> Reconstruction:
    """Surfaces of every frame of an admitted study (`intake.study.admit`), mm, the study's axes.

    A frame that observes none of the requested surfaces is left out. Of several frames one that
    fails fails alone, and is named in the result; raises its error where all do. What `checkpoints`
    has of these very fits is not fitted again, and changes nothing.

    Same study, options, thread count and library versions: same surfaces, bit for bit. Raises
    InputError for input that no field can be fitted to, InternalError(NO_SURFACE) when a fit
    encloses nothing, Cancelled when the observer asks to stop.
    """
    watcher, kept = observer or Unobserved(), checkpoints or Unkept()
    frames = [frame for frame in study.frames if frame_surfaces(frame, options)]
    stacks = [build_stack(study, frame) for frame in frames]
    plan = sequence_plan(stacks, options)
    failures: dict[int, ServiceError] = {}
    posed_frames: dict[int, PosedFrame] = {}
    for index, stack in enumerate(stacks):
        with _failing_alone(index, failures):
            posed_frames[index] = _posed_frame(
                stack, frame_surfaces(frames[index], options), plan.unit_frame, options
            )
    sequence = FrameSequence(plan, posed_frames, options)
    fits: dict[int, FrameFit] = {}
    done = 0.0
    for step, cost in zip(plan.steps, plan.costs, strict=True):
        index, end = step.frame, done + cost / sum(plan.costs)
        share = FrameShare(watcher, stacks[index].label, 0, 1, done, min(end, 1.0))
        done = end
        if index in posed_frames:
            place = Checkpoint(kept, f"frame-{stacks[index].label}")
            with _failing_alone(index, failures):
                fits[index] = _reconstruct_frame(index, step, sequence, options, share, place)
            if index in failures:
                sequence.forget(index)
    if failures and not fits:
        raise failures[min(failures)]
    return Reconstruction(
        study.subject_id,
        study.axes,
        tuple(fits[index] for index in sorted(fits)),
        tuple(FailedFrame(stacks[i].label, failures[i].detail) for i in sorted(failures)),
        sequence.warnings(),
    )


@contextmanager
def _failing_alone(index: int, failures: dict[int, ServiceError]) -> Iterator[None]:
    try:
        yield
    except InputError as error:
        failures[index] = error
    except InternalError as error:
        # A store that does not answer, to one, is no fault of the frame.
        if error.type not in _OF_A_FRAME:
            raise
        failures[index] = error


def _posed_frame(
    stack: SliceStack, surfaces: list[Structure], frame: UnitFrame | None, options: Options
) -> PosedFrame:
    unit_frame = frame or unit_frame_of(stack)
    unit_stack = normalised(stack, unit_frame)
    problem = posed(unit_stack, partition(surfaces), options.sampling)
    unit_mm, cell = unit_frame.half_extent_mm, finest_cell(unit_frame, options)
    check_workload(len(stack.slices), problem.hull, cell * unit_mm, cell, len(surfaces), options)
    # Before the fit: a base that cannot be found is not found out in vain.
    bases = {s: find_base(stack, s) for s in surfaces} if options.base is Base.OPEN else {}
    return PosedFrame(stack, unit_frame, problem, bases)


def _reconstruct_frame(
    index: int,
    step: FitStep,
    sequence: FrameSequence,
    options: Options,
    observer: FrameShare,
    checkpoint: Checkpoint,
) -> FrameFit:
    frame = sequence.posed[index]
    stack, problem, unit_frame = frame.stack, frame.problem, frame.unit_frame
    surfaces, unit_mm = problem.classes.surfaces, unit_frame.half_extent_mm
    evidence = sequence.evidence_of(index)
    furthest = min(options.alignment.max_shift_mm / unit_mm, FURTHEST_SHIFT)

    def free_shifts() -> SliceShifts:
        return SliceShifts(problem.shown, evidence, furthest, turning=options.alignment.rotate)

    noise = _contour_noise(evidence, options, unit_mm)
    suited = tempered(options, noise)
    shifts = free_shifts()
    fitting, meshing, refitting, others = _parts(observer, problem, options)
    start = sequence.start_of(step)
    schedule = suited if start is None else tempered(warm_options(options), noise)
    fit = solved(
        problem,
        shifts,
        schedule,
        fitting,
        start=start.field if start else None,
        checkpoint=checkpoint.of("fit"),
    )
    motion = sequence.fitted(index, fit.field, shifts.found())
    touching = outline_points(moved_stack(problem.stack, motion))
    found = surfaces_of(fit, problem, touching, unit_frame, options, meshing)
    for closed in (found.meshes, found.unremeshed):
        closed |= {s: cut_open(closed[s], base) for s, base in frame.bases.items() if s in closed}
    first = FirstFit(problem, unit_frame, fit, motion)
    wanted = options.holdout is Holdout.LEAVE_ONE_SLICE_OUT
    contour_noise = evidence.contour_noise
    return FrameFit(
        label=stack.label,
        time_ms=stack.time_ms,
        surfaces=found.meshes,
        unremeshed=found.unremeshed,
        slices=_slice_fits(stack, problem.stack, unit_frame, motion, evidence),
        levels=_level_fits(fit, unit_frame, schedule),
        contour_noise_mm=None if contour_noise is None else unit_mm * contour_noise,
        curvature={
            structure: curvature_of(fit, place, found.meshes[structure], unit_frame, meshing)
            for place, structure in enumerate(surfaces)
        },
        held_out=(
            held_out(first, suited, refitting.told_as(Stage.REFITTING), checkpoint)
            if wanted
            else {}
        ),
        members=ensemble(
            problem, unit_frame, free_shifts, suited, others.told_as(Stage.REFITTING), checkpoint
        ),
        started_from=start.label if start else None,
    )


def _parts(
    observer: FrameShare, problem: FieldProblem, options: Options
) -> tuple[FrameShare, FrameShare, FrameShare, FrameShare]:
    """The frame's work by what it costs: fit, meshing, refits without a slice, other seeds."""
    refits = len(slices_to_hold_out(problem)) if options.holdout is not Holdout.NONE else 0
    ends = np.cumsum([_FIT_SHARE, 1.0 - _FIT_SHARE, REFIT_COST * refits, options.ensemble])
    starts = np.concatenate([[0.0], ends[:-1]])
    fitting, meshing, refitting, others = (
        observer.part(float(start), float(end))
        for start, end in zip(starts / ends[-1], ends / ends[-1], strict=True)
    )
    return fitting, meshing, refitting, others


def _contour_noise(evidence: ShiftEvidence, options: Options, unit_mm: float) -> float:
    """How unsteady outlines are taken to be, unit lengths."""
    given_mm = options.loss.contour_noise_mm
    return (evidence.contour_noise or 0.0) if given_mm is None else given_mm / unit_mm


def _slice_fits(
    stack: SliceStack,
    unit_stack: UnitStack,
    frame: UnitFrame,
    motion: SliceMotion,
    evidence: ShiftEvidence,
) -> tuple[SliceFit, ...]:
    unit_mm = frame.half_extent_mm
    # A turn is about the normal of the axes that it was found in.
    normals = frame.displacement_to_mm(np.stack([s.normal for s in unit_stack.slices])) / unit_mm
    shifts_mm, pivots_mm = frame.displacement_to_mm(motion.shifts), frame.to_mm(motion.pivots)
    deviations_mm = unit_mm * evidence.deviations()
    return tuple(
        SliceFit(
            id=slice_.id,
            view=slice_.view,
            normal=normals[index],
            shift_mm=shifts_mm[index],
            shift_deviation_mm=(
                float(deviations_mm[index]) if evidence.crossings[index] > 0 else None
            ),
            crossings=int(evidence.crossings[index]),
            turn_rad=float(motion.turns[index]),
            pivot_mm=pivots_mm[index],
            contours_mm={
                structure: tuple(ContourPoints(o.points_mm, o.closed) for o in outlines)
                for structure, outlines in slice_.outlines.items()
            },
        )
        for index, slice_ in enumerate(stack.slices)
    )


def _level_fits(fit: FieldFit, frame: UnitFrame, options: Options) -> tuple[LevelFit, ...]:
    return tuple(
        LevelFit(
            level=level.level,
            radius_mm=frame.half_extent_mm
            * level_radius(level.level, options.levels, options.sampling),
            samples=level.samples,
            bce=level.bce,
            hinge=level.hinge,
            total=level.bce + options.loss.hinge_weight * level.hinge,
        )
        for level in fit.levels
    )
