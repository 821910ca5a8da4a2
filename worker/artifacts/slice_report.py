"""One slice of one frame, measured: its motion, and what the surfaces do on its plane."""

import math
from collections.abc import Mapping, Sequence

from intake.planes import Plane
from schemas.frame_report import SliceReport
from schemas.measures import DistanceSummary
from schemas.vocabulary import Structure
from worker.arrays import SomePoints, Vector
from worker.artifacts.measured import MeasuredSlice
from worker.evaluation.plane_overlap import plane_dice
from worker.evaluation.residuals import Residuals, all_distances_mm
from worker.evaluation.section import section_lines
from worker.evaluation.summary import summarised
from worker.reconstruction.result import SliceFit
from worker.surface_mesh import SurfaceMesh

Surfaces = Mapping[Structure, SurfaceMesh]


def slice_report(
    fit: SliceFit,
    residuals: Mapping[Structure, Sequence[Residuals]],
    cut: MeasuredSlice,
    closed: Sequence[Structure],
    held_out_mm: Mapping[Structure, DistanceSummary],
) -> SliceReport:
    """residuals: of the slice's own contours, those of a structure in its order. cut: the surfaces
    on its plane. closed: which of them are. held_out_mm: see the report.
    """
    x, y, z = fit.shift_mm.tolist()
    plane = Plane.through(cut.origin_mm, cut.normal)

    def dice(structure: Structure) -> float | None:
        if structure not in closed:
            return None
        outlines = [one.outline for one in residuals[structure]]
        loops = [line[:-1] for line in cut.sections.get(structure, ())]
        return plane_dice(loops, outlines, plane)

    return SliceReport(
        id=fit.id,
        view=fit.view,
        shift_mm=(x, y, z),
        shift_deviation_mm=fit.shift_deviation_mm,
        crossings=fit.crossings,
        rotation_deg=math.degrees(fit.turn_rad),
        contour_residual_mm={s: summarised(all_distances_mm(r)) for s, r in residuals.items()},
        held_out_mm=dict(held_out_mm),
        dice={s: dice(s) for s in residuals},
    )


def plane_origin_mm(fit: SliceFit) -> Vector:
    """A point (3,) of a slice's plane where alignment moved it to, patient mm."""
    points_mm = next(
        (contours[0].points_mm for contours in fit.contours_mm.values() if contours),
        fit.pivot_mm[None],
    )
    origin_mm: Vector = fit.aligned_mm(points_mm[:1])[0]
    return origin_mm


def own_residuals(
    slice_id: str, residuals: Mapping[Structure, Sequence[Residuals]]
) -> dict[Structure, list[Residuals]]:
    """Those of one slice's contours, by structure; structures that it does not show left out."""
    own = {
        structure: [one for one in every if one.outline.slice_id == slice_id]
        for structure, every in residuals.items()
    }
    return {structure: some for structure, some in own.items() if some}


def cut_by(fit: SliceFit, surfaces: Surfaces, references: Surfaces) -> MeasuredSlice:
    """The surfaces, and their references, on a slice's plane where alignment moved it to."""
    origin_mm = plane_origin_mm(fit)

    def cut(meshes: Surfaces) -> dict[Structure, list[SomePoints]]:
        lines = {s: section_lines(mesh, origin_mm, fit.normal) for s, mesh in meshes.items()}
        return {structure: some for structure, some in lines.items() if some}

    return MeasuredSlice(fit.id, fit.view, origin_mm, fit.normal, cut(surfaces), cut(references))
