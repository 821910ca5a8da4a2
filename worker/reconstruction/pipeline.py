"""The whole way from a contour study to surfaces: the only file that knows every stage.

study -> stack (mm) -> unit stack + UnitFrame -> levels of samples -> tissue field -> isosurfaces ->
one component -> level-set projection -> mm -> closed or open base.

Here frames are posed and shared out; `chain` takes them one after another, `frame_pipeline` goes
the way from a posed frame on.
"""

from intake.support import frame_surfaces
from schemas.frame_report import StudyFrame
from schemas.options import Base, Options
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.checkpoints import Checkpoints, Unkept
from worker.crew import Alone, Crew, Part
from worker.observer import Cancelled, Observer, Unobserved
from worker.progress_share import ProgressShare
from worker.reconstruction.base_plane import find_base
from worker.reconstruction.chain import FrameResults, fitted_chain
from worker.reconstruction.cycle import chains
from worker.reconstruction.field_problem import posed
from worker.reconstruction.meshing import finest_cell
from worker.reconstruction.normalisation import UnitFrame, normalised, unit_frame_of
from worker.reconstruction.posed_frame import PosedFrame
from worker.reconstruction.result import FailedFrame, Reconstruction, StoppedEarly
from worker.reconstruction.sequence import FrameSequence, sequence_plan
from worker.reconstruction.slice_stack import SliceStack
from worker.reconstruction.stacking import build_stack
from worker.reconstruction.tissues import partition
from worker.reconstruction.workload import check_workload

_NOT_BEGUN = "It was not finished when the job was cancelled. For all frames, restart the job."


def reconstruct(
    study: ContourStudy,
    options: Options,
    observer: Observer | None = None,
    checkpoints: Checkpoints | None = None,
    crew: Crew | None = None,
) -> Reconstruction:
    """Surfaces of every frame of an admitted study (`intake.study.admit`), mm, the study's axes.

    A frame that observes none of the requested surfaces is left out. Of several frames one that
    fails fails alone, and is named in the result; raises its error where all do. What `checkpoints`
    has of these very fits is not fitted again, and changes nothing; nor does it matter who of the
    `crew` fits which frame.

    Same study, options, thread count and library versions: same surfaces, bit for bit. Raises
    InputError for input that no field can be fitted to, InternalError(NO_SURFACE) when a fit
    encloses nothing, Cancelled when the observer asks to stop: StoppedEarly, with the frames that
    were finished, where there are any.
    """
    watcher, kept, hands = observer or Unobserved(), checkpoints or Unkept(), crew or Alone()
    frames = [frame for frame in study.frames if frame_surfaces(frame, options)]
    stacks = [build_stack(study, frame) for frame in frames]
    plan = sequence_plan(stacks, options)
    results = FrameResults()
    posed_frames: dict[int, PosedFrame] = {}
    for index, stack in enumerate(stacks):
        with results.failing_alone(index):
            posed_frames[index] = _posed_frame(
                stack, frame_surfaces(frames[index], options), plan.unit_frame, options
            )
    sequence = FrameSequence(plan, posed_frames, options)
    steps = [step for step in plan.steps if step.frame in posed_frames]
    whole, done = plan.cost(steps), 0.0
    # Until one is there that others go on from, and whose shifts hold for all.
    while steps and not (results.fits or results.is_stopped):
        first = [steps.pop(0)]
        share = ProgressShare(watcher, done / whole, (done + plan.cost(first)) / whole)
        results.add(fitted_chain(sequence, first, share, kept))
        done += plan.cost(first)
    parts = [Part(fitted_chain, (sequence.branch(), one), plan.cost(one)) for one in chains(steps)]
    if parts and not results.is_stopped:
        for found in hands.all_of(parts, ProgressShare(watcher, done / whole), kept):
            results.add(found)
    fits, failures = results.fits, results.failures
    if results.is_stopped and not fits:
        raise Cancelled
    if failures and not fits:
        raise failures[min(failures)]
    reasons = {index: error.detail for index, error in failures.items()}
    unfitted = posed_frames.keys() - fits.keys() - failures.keys()
    reasons |= dict.fromkeys(unfitted, _NOT_BEGUN)
    found = Reconstruction(
        study.subject_id,
        study.axes,
        tuple(fits[index] for index in sorted(fits)),
        tuple(FailedFrame(stacks[index].label, reasons[index]) for index in sorted(reasons)),
        sequence.warnings(),
        stopped_early=results.is_stopped,
        study_frames=tuple(StudyFrame(label=f.label, time_ms=f.time_ms) for f in study.frames),
    )
    if results.is_stopped:
        raise StoppedEarly(found)
    return found


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
