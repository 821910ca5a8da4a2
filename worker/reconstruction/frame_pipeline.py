"""One frame from the posed problem to its surfaces: fit, mesh, and fit again where asked for.

A part of the pipeline: it joins stages that do not know each other.
"""

import numpy as np

from intake.effort import REFIT_COST
from schemas.job import Stage
from schemas.options import Holdout, Options
from worker.checkpoints import Checkpoint
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.base_plane import cut_open
from worker.reconstruction.cycle import FitStep
from worker.reconstruction.field_problem import FieldProblem, moved_stack, outline_points, solved
from worker.reconstruction.fit import FieldFit
from worker.reconstruction.frame_share import FrameShare
from worker.reconstruction.meshing import curvature_of, surfaces_of
from worker.reconstruction.motion import SliceMotion
from worker.reconstruction.normalisation import UnitFrame
from worker.reconstruction.refits import FirstFit, ensemble, held_out, slices_to_hold_out
from worker.reconstruction.result import ContourPoints, FrameFit, LevelFit, SliceFit
from worker.reconstruction.sampling import level_radius
from worker.reconstruction.sequence import FrameSequence
from worker.reconstruction.shift_evidence import ShiftEvidence
from worker.reconstruction.slice_stack import SliceStack
from worker.reconstruction.stack_evidence import FURTHEST_SHIFT
from worker.reconstruction.tempering import tempered
from worker.reconstruction.unit_stack import UnitStack
from worker.reconstruction.warm_start import warm_options

_FIT_SHARE = 0.9
"""Part of a frame's work that is the fit; the rest is meshing."""


def reconstruct_frame(
    step: FitStep, sequence: FrameSequence, observer: FrameShare, checkpoint: Checkpoint
) -> FrameFit:
    """The surfaces of the step's frame, mm, and what the fit found.

    Raises InternalError(NO_SURFACE) when the fit encloses nothing, Cancelled.
    """
    index, options = step.frame, sequence.options
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
