"""From a fitted field to surfaces in mm: level sets, one component each, even triangles if asked.

A part of the pipeline: it joins stages that do not know each other.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from schemas.job import Progress, Stage
from schemas.options import Options
from schemas.problem import InternalError, ProblemType
from schemas.vocabulary import Structure
from worker.arrays import Points, SomeFaces, SomePoints
from worker.observer import Cancelled, Observer
from worker.reconstruction.component import outward, touched_component
from worker.reconstruction.field_evaluation import FieldEvaluation
from worker.reconstruction.field_problem import FieldProblem
from worker.reconstruction.fit import FieldFit
from worker.reconstruction.isosurface import Triangles, isosurfaces
from worker.reconstruction.level_set_curvature import level_set_curvature
from worker.reconstruction.normalisation import UnitFrame
from worker.reconstruction.projection import project
from worker.reconstruction.result import LevelSetCurvature
from worker.reconstruction.unfolding import unfolded
from worker.remeshing.remeshing import remesh
from worker.surface_mesh import SurfaceMesh

_WIDEST_CELL = 0.1
"""Edge of the finest cell, unit lengths, at most: a mouse's heart is a few millimetres long."""

_REACH = 0.5
"""In finest cells: no vertex is drawn further onto the level set."""


@dataclass(frozen=True, eq=False)
class FieldSurfaces:
    """Surfaces in mm, and where `target_edge_mm` is given what they were before remeshing."""

    meshes: dict[Structure, SurfaceMesh]
    unremeshed: dict[Structure, SurfaceMesh]


def surfaces_of(
    fit: FieldFit,
    problem: FieldProblem,
    touching: Mapping[Structure, Points],
    frame: UnitFrame,
    options: Options,
    observer: Observer,
    *,
    may_be_empty: bool = False,
) -> FieldSurfaces:
    """Closed surfaces of a fit.

    touching: by structure, (n, 3) unit, outline points that tell a surface from islands.
    may_be_empty: leave out a surface without outlines, or of which the field encloses nothing.
    Raises InternalError(NO_SURFACE) for such a surface otherwise, Cancelled when asked to stop.
    """
    cell = finest_cell(frame, options)
    evaluation = FieldEvaluation(fit.field, fit.surface_logits, observer)
    observer.advanced(Progress(fraction=0.0, stage=Stage.MESHING))
    level_sets = isosurfaces(evaluation.logits, problem.hull.lower, problem.hull.upper, cell)
    surfaces = problem.classes.surfaces
    meshes: dict[Structure, SurfaceMesh] = {}
    unremeshed: dict[Structure, SurfaceMesh] = {}
    for index, (structure, level_set) in enumerate(zip(surfaces, level_sets, strict=True)):
        if observer.is_cancelled():
            raise Cancelled
        if may_be_empty and (structure not in touching or not len(level_set.faces)):
            continue
        done = (index + 1) / len(level_sets)
        observer.advanced(Progress(fraction=done, stage=Stage.MESHING))
        vertices, faces = _kept(level_set, touching[structure], structure)

        def on_surface(points_unit: Points, surface: int = index) -> tuple[np.ndarray, Points]:
            return evaluation.logits_and_gradient(points_unit, surface)

        drawn = project(vertices, on_surface, options.mesh.projection_steps, _REACH * cell)
        vertices = unfolded(vertices, drawn, faces)
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
    return FieldSurfaces(meshes, unremeshed)


def curvature_of(
    fit: FieldFit, index: int, mesh: SurfaceMesh, frame: UnitFrame, observer: Observer
) -> LevelSetCurvature:
    """Of the fit's surface number `index`, at the vertices of its mesh. Raises Cancelled."""
    evaluation = FieldEvaluation(fit.field, fit.surface_logits, observer)
    vertices_unit = frame.to_unit(mesh.vertices_mm)
    gaussian, mean = level_set_curvature(*evaluation.gradient_and_hessian(vertices_unit, index))
    unit_mm = frame.half_extent_mm
    return LevelSetCurvature(gaussian / unit_mm**2, mean / unit_mm)


def finest_cell(frame: UnitFrame, options: Options) -> float:
    """Edge of the finest lattice cells, unit lengths."""
    return min(options.mesh.grid_mm / frame.half_extent_mm, _WIDEST_CELL)


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
