"""The whole way from a contour study to surfaces: the only file that knows every stage.

study -> stack (mm) -> unit stack + UnitFrame -> levels of samples -> tissue field -> isosurfaces ->
one component -> level-set projection -> mm -> closed or open base.
"""

import numpy as np

from intake.support import frame_surfaces
from schemas.job import Progress, Stage
from schemas.options import Base, Options
from schemas.problem import InternalError, ProblemType
from schemas.study import ContourStudy, Frame
from schemas.vocabulary import Structure
from worker.arrays import Points, SomeFaces, SomePoints
from worker.reconstruction.base_plane import cut_open, find_base
from worker.reconstruction.component import outward, touched_component
from worker.reconstruction.field_evaluation import FieldEvaluation
from worker.reconstruction.fit import FieldFit, fit_field
from worker.reconstruction.frame_share import FrameShare
from worker.reconstruction.hull import Hull, inflated_hull
from worker.reconstruction.isosurface import Triangles, isosurfaces
from worker.reconstruction.normalisation import UnitFrame, normalise
from worker.reconstruction.observer import Cancelled, Observer, Unobserved
from worker.reconstruction.projection import project
from worker.reconstruction.remeshing import remesh
from worker.reconstruction.result import ContourPoints, FrameFit, LevelFit, Reconstruction, SliceFit
from worker.reconstruction.samples import LabelledSamples
from worker.reconstruction.sampling import level_radius, sample_level
from worker.reconstruction.slice_stack import SliceStack
from worker.reconstruction.stack_ends import past_the_ends
from worker.reconstruction.stacking import build_stack
from worker.reconstruction.tissues import Partition, partition
from worker.reconstruction.unit_stack import UnitStack
from worker.reconstruction.workload import check_workload
from worker.surface_mesh import SurfaceMesh

_FIT_SHARE = 0.9
"""Part of a frame's work that is the fit; the rest is meshing."""

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
    fitted_to = unit_stack.showing(classes.surfaces)
    fit = fit_field(samples_of, fitted_to, classes, options, unit_mm, fitting)
    meshing = observer.part(_FIT_SHARE, 1.0)
    meshes = _mesh(unit_stack, unit_frame, hull, classes, fit, cell, options, meshing)
    meshes |= {s: cut_open(meshes[s], base) for s, base in bases.items()}
    return FrameFit(
        label=frame.label,
        time_ms=frame.time_ms,
        surfaces=meshes,
        slices=_slice_fits(stack, unit_frame.displacement_to_mm(fit.shifts_unit)),
        levels=_level_fits(fit, unit_frame, options),
    )


def _mesh(
    stack: UnitStack,
    frame: UnitFrame,
    hull: Hull,
    classes: Partition,
    fit: FieldFit,
    cell: float,
    options: Options,
    observer: Observer,
) -> dict[Structure, SurfaceMesh]:
    evaluation = FieldEvaluation(fit.field, fit.surface_logits, observer)
    observer.advanced(Progress(fraction=0.0, stage=Stage.MESHING))
    level_sets = isosurfaces(evaluation.logits, hull.lower, hull.upper, cell)
    meshes = {}
    for index, (structure, level_set) in enumerate(zip(classes.surfaces, level_sets, strict=True)):
        if observer.is_cancelled():
            raise Cancelled
        done = (index + 1) / len(level_sets)
        observer.advanced(Progress(fraction=done, stage=Stage.MESHING))
        touching = _aligned_outline_points(stack, fit, structure)
        vertices, faces = _kept(level_set, touching, structure)

        def on_surface(points_unit: Points, surface: int = index) -> tuple[np.ndarray, Points]:
            return evaluation.logits_and_gradient(points_unit, surface)

        vertices = project(vertices, on_surface, options.mesh.projection_steps, cell)
        if options.target_edge_mm is not None:
            edge = options.target_edge_mm / frame.half_extent_mm
            vertices, faces = remesh(vertices, faces, edge)
            vertices = project(vertices, on_surface, options.mesh.projection_steps, edge)
        meshes[structure] = SurfaceMesh(frame.to_mm(vertices), outward(vertices, faces))
    return meshes


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


def _aligned_outline_points(stack: UnitStack, fit: FieldFit, structure: Structure) -> Points:
    return np.concatenate(
        [
            slice_.lift(outline.points) - shift
            for slice_, shift in zip(stack.slices, fit.shifts_unit, strict=True)
            for outline in slice_.outlines.get(structure, ())
        ]
    )


def _slice_fits(stack: SliceStack, shifts_mm: Points) -> tuple[SliceFit, ...]:
    return tuple(
        SliceFit(
            id=slice_.id,
            view=slice_.view,
            shift_mm=shift,
            contours_mm={
                structure: tuple(ContourPoints(o.points_mm, o.closed) for o in outlines)
                for structure, outlines in slice_.outlines.items()
            },
        )
        for slice_, shift in zip(stack.slices, shifts_mm, strict=True)
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
