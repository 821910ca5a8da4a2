"""The whole way from a contour study to surfaces: the only file that knows every stage.

study -> stack (mm) -> unit stack + UnitFrame -> levels of samples -> tissue field -> isosurfaces ->
one component -> level-set projection -> mm -> closed or open base.
"""

from collections.abc import Mapping
from functools import partial

import numpy as np

from intake.support import frame_surfaces
from schemas.job import Progress, Stage
from schemas.options import Base, Options
from schemas.problem import InternalError, ProblemType
from schemas.study import ContourStudy, Frame
from schemas.vocabulary import Structure
from worker.arrays import Points, SomeFaces, SomePoints
from worker.observer import Cancelled, Observer, Unobserved
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.base_plane import cut_open, find_base
from worker.reconstruction.component import outward, touched_component
from worker.reconstruction.crossings import crossing_evidence
from worker.reconstruction.field_evaluation import FieldEvaluation
from worker.reconstruction.fit import FieldFit, fit_field
from worker.reconstruction.frame_share import FrameShare
from worker.reconstruction.hull import Hull, inflated_hull
from worker.reconstruction.isosurface import Triangles, isosurfaces
from worker.reconstruction.motion import SliceMotion, moved_back
from worker.reconstruction.normalisation import UnitFrame, normalise
from worker.reconstruction.projection import project
from worker.reconstruction.result import ContourPoints, FrameFit, LevelFit, Reconstruction, SliceFit
from worker.reconstruction.samples import LabelledSamples
from worker.reconstruction.sampling import level_radius, sample_level
from worker.reconstruction.shift_evidence import ShiftEvidence
from worker.reconstruction.slice_stack import SliceStack
from worker.reconstruction.stack_ends import past_the_ends
from worker.reconstruction.stack_smoothness import smoothness_evidence
from worker.reconstruction.stacking import build_stack
from worker.reconstruction.tempering import tempered
from worker.reconstruction.tissues import Partition, partition
from worker.reconstruction.unit_stack import UnitStack
from worker.reconstruction.workload import check_workload
from worker.remeshing.remeshing import remesh
from worker.surface_mesh import SurfaceMesh

_FIT_SHARE = 0.9
"""Part of a frame's work that is the fit; the rest is meshing."""

_CONTOUR_NOISE_MM = 0.25
"""How well an observer's outline is known, at best: crossings do not fix a shift any better."""

_WIDEST_PRIOR, _FURTHEST_SHIFT = 0.1, 0.4
"""Bounds on the shift prior and on shifts, unit lengths: a mouse's breath is not a man's."""

_WIDEST_CELL = 0.1
"""Edge of the finest cell, unit lengths, at most: a mouse's heart is a few millimetres long."""


def reconstruct(
    study: ContourStudy, options: Options, observer: Observer | None = None
) -> Reconstruction:
    """Surfaces of every frame of an admitted study (`intake.study.admit`), mm, the study's axes.

    A frame that observes none of the requested surfaces is left out.

    Same study, options, thread count and library versions: same surfaces, bit for bit. Raises
    InputError for input that no field can be fitted to, InternalError(NO_SURFACE) when a fit
    encloses nothing, Cancelled when the observer asks to stop.
    """
    watcher = observer or Unobserved()
    frames = [frame for frame in study.frames if frame_surfaces(frame, options)]
    fits = tuple(
        _reconstruct_frame(
            study, frame, options, FrameShare(watcher, frame.label, index, len(frames))
        )
        for index, frame in enumerate(frames)
    )
    return Reconstruction(study.subject_id, study.axes, fits)


def _reconstruct_frame(
    study: ContourStudy, frame: Frame, options: Options, observer: FrameShare
) -> FrameFit:
    stack = build_stack(study, frame)
    unit_stack, unit_frame = normalise(stack)
    inflation = options.sampling.hull_inflation
    ends = past_the_ends(unit_stack, inflation)
    hull = inflated_hull(np.concatenate([unit_stack.points_unit, ends]), inflation)
    classes = partition(frame_surfaces(frame, options))
    unit_mm = unit_frame.half_extent_mm
    cell = min(options.mesh.grid_mm / unit_mm, _WIDEST_CELL)
    check_workload(len(stack.slices), hull, cell * unit_mm, cell, len(classes.surfaces), options)
    # Before the fit: a base that cannot be found is not found out in vain.
    bases = {s: find_base(stack, s) for s in classes.surfaces} if options.base is Base.OPEN else {}
    rng = np.random.default_rng(options.seed)

    def samples_of(level: int) -> LabelledSamples:
        radius = level_radius(level, options.levels, options.sampling)
        return sample_level(
            unit_stack, classes.surfaces, hull, radius, options.sampling, rng, observer
        )

    fitting = observer.part(0.0, _FIT_SHARE)
    evidence = _evidence(unit_stack.showing(classes.surfaces), options, unit_mm)
    furthest = min(options.alignment.max_shift_mm / unit_mm, _FURTHEST_SHIFT)
    shifts = SliceShifts(
        unit_stack.showing(classes.surfaces), evidence, furthest, turning=options.alignment.rotate
    )
    suited = tempered(options, _contour_noise(evidence, options, unit_mm))
    fit = fit_field(samples_of, shifts, classes, suited, fitting)
    meshing = observer.part(_FIT_SHARE, 1.0)
    motion = shifts.found()
    outlines = _aligned_outlines(unit_stack, motion)
    meshes, unremeshed = _mesh(outlines, unit_frame, hull, classes, fit, cell, options, meshing)
    for closed in (meshes, unremeshed):
        closed |= {s: cut_open(closed[s], base) for s, base in bases.items() if s in closed}
    return FrameFit(
        label=frame.label,
        time_ms=frame.time_ms,
        surfaces=meshes,
        unremeshed=unremeshed,
        slices=_slice_fits(stack, unit_stack, unit_frame, motion, evidence),
        levels=_level_fits(fit, unit_frame, options),
        contour_noise_mm=None
        if evidence.contour_noise is None
        else unit_mm * evidence.contour_noise,
    )


def _evidence(stack: UnitStack, options: Options, unit_mm: float) -> ShiftEvidence:
    """What is known of the slices' shifts, and of how unsteady outlines are, before the fit."""
    prior = min(options.alignment.prior_mm / unit_mm, _WIDEST_PRIOR)
    noise = min(_CONTOUR_NOISE_MM / unit_mm, prior)
    crossed = crossing_evidence(stack, prior, noise, turning=options.alignment.rotate)
    if not options.align_slices:
        return crossed.in_place(prior)
    if crossed.crossings.any():
        return crossed
    return smoothness_evidence(stack, prior, noise, unit_mm, turning=options.alignment.rotate)


def _contour_noise(evidence: ShiftEvidence, options: Options, unit_mm: float) -> float:
    """How unsteady outlines are taken to be, unit lengths."""
    given_mm = options.loss.contour_noise_mm
    return (evidence.contour_noise or 0.0) if given_mm is None else given_mm / unit_mm


def _mesh(
    outlines: Mapping[Structure, Points],
    frame: UnitFrame,
    hull: Hull,
    classes: Partition,
    fit: FieldFit,
    cell: float,
    options: Options,
    observer: Observer,
) -> tuple[dict[Structure, SurfaceMesh], dict[Structure, SurfaceMesh]]:
    """The surfaces, and where `target_edge_mm` is given what they were before remeshing, in mm."""
    evaluation = FieldEvaluation(fit.field, fit.surface_logits, observer)
    observer.advanced(Progress(fraction=0.0, stage=Stage.MESHING))
    level_sets = isosurfaces(evaluation.logits, hull.lower, hull.upper, cell)
    meshes: dict[Structure, SurfaceMesh] = {}
    unremeshed: dict[Structure, SurfaceMesh] = {}
    for index, (structure, level_set) in enumerate(zip(classes.surfaces, level_sets, strict=True)):
        if observer.is_cancelled():
            raise Cancelled
        done = (index + 1) / len(level_sets)
        observer.advanced(Progress(fraction=done, stage=Stage.MESHING))
        vertices, faces = _kept(level_set, outlines[structure], structure)

        def on_surface(points_unit: Points, surface: int = index) -> tuple[np.ndarray, Points]:
            return evaluation.logits_and_gradient(points_unit, surface)

        vertices = project(vertices, on_surface, options.mesh.projection_steps, cell)
        faces = outward(vertices, faces)
        meshes[structure] = SurfaceMesh(frame.to_mm(vertices), faces)
        if options.target_edge_mm is not None:
            unremeshed[structure] = meshes[structure]
            edge = options.target_edge_mm / frame.half_extent_mm
            even_vertices, even_faces = remesh(
                vertices,
                faces,
                edge,
                partial(project, logits_and_gradient=on_surface, steps=1, reach=0.5 * edge),
                observer,
            )
            meshes[structure] = SurfaceMesh(frame.to_mm(even_vertices), even_faces)
    return meshes, unremeshed


def _kept(
    level_set: Triangles, touching: SomePoints, structure: Structure
) -> tuple[SomePoints, SomeFaces]:
    if len(level_set.faces) == 0:
        raise InternalError(
            ProblemType.NO_SURFACE,
            f"The fitted field encloses nothing for {structure}; raise `iterations_per_level` or "
            "`levels`, lower `optimizer.learning_rate` or `mesh.grid_mm`, or leave that surface "
            "out of `surfaces`.",
        )
    return touched_component(level_set.vertices, level_set.faces, touching)


def _aligned_outlines(stack: UnitStack, motion: SliceMotion) -> dict[Structure, Points]:
    """All outline points (n, 3) of every structure, moved back by their slices' motion."""
    points: dict[Structure, list[Points]] = {}
    for index, slice_ in enumerate(stack.slices):
        back = partial(
            moved_back,
            shift=motion.shifts[index],
            turn=float(motion.turns[index]),
            pivot=motion.pivots[index],
            normal=slice_.normal,
        )
        for structure, outlines in slice_.outlines.items():
            points.setdefault(structure, []).extend(back(slice_.lift(o.points)) for o in outlines)
    return {structure: np.concatenate(parts) for structure, parts in points.items()}


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
