"""The report: every surface and slice of a reconstruction, measured."""

import math
from collections.abc import Mapping, Sequence

from schemas.options import Base, Options
from schemas.report import (
    FrameReport,
    FunctionReport,
    LevelReport,
    Provenance,
    Report,
    SliceReport,
)
from schemas.vocabulary import Structure
from worker.arrays import Vector
from worker.artifacts.contour_warnings import contour_warnings
from worker.artifacts.evidence import aligned_outlines
from worker.artifacts.left_ventricle import left_ventricle_report
from worker.artifacts.support_warnings import support_warnings
from worker.artifacts.surface_crossings import crossing_triangles
from worker.artifacts.surface_report import surface_report
from worker.evaluation.extrapolation import apex_to_base
from worker.evaluation.function import lv_function, shrinkage_percent
from worker.evaluation.plane_overlap import plane_dice
from worker.evaluation.residuals import Residuals, all_distances_mm, contour_residuals
from worker.evaluation.summary import summarised
from worker.evaluation.topology import is_watertight
from worker.reconstruction.result import FrameFit, Reconstruction, SliceFit
from worker.surface_mesh import SurfaceMesh

_Surfaces = Mapping[Structure, SurfaceMesh]


def build_report(
    reconstruction: Reconstruction,
    *,
    options: Options,
    warnings: Sequence[str],
    timings_s: Mapping[str, float],
    provenance: Provenance,
) -> Report:
    """Measure a reconstruction.

    Contour residuals are exact distances, in mm, from the observed outlines' points, moved back by
    their slice's shift, to the surface. Long-axis chords at the valves are no observation and are
    not measured. A volume is only given for a watertight surface. Where a surface goes on beyond
    its short-axis slices and no long-axis contour follows it, and where views contradict each
    other, a warning is added.

    Raises:
        InternalError: for a surface that faces inward, or that no contour was observed of.
    """
    frames = [_frame(fit, options) for fit in reconstruction.frames]
    return Report(
        subject_id=reconstruction.subject_id,
        axes=reconstruction.axes,
        frames=frames,
        function=_function(frames),
        warnings=[
            *warnings,
            *(text for one in frames for text in contour_warnings(one.label, one.contour_noise_mm)),
            *(text for one in frames for text in support_warnings(one.label, one.surfaces)),
        ],
        timings_s=dict(timings_s),
        options=options,
        provenance=provenance,
    )


def mesh_name(frame_label: str, structure: Structure) -> str:
    """What a surface is called, as a file and inside it: `ED_lv_endo`."""
    return f"{frame_label}_{structure}"


def _frame(fit: FrameFit, options: Options) -> FrameReport:
    outlines = aligned_outlines(fit)
    toward_base = apex_to_base(outlines)
    residuals = {
        structure: contour_residuals(mesh, outlines.get(structure, ()))
        for structure, mesh in fit.surfaces.items()
    }
    crossing = crossing_triangles(fit.surfaces)
    closed = {s: mesh for s, mesh in fit.surfaces.items() if is_watertight(mesh)}
    return FrameReport(
        label=fit.label,
        time_ms=fit.time_ms,
        contour_noise_mm=fit.contour_noise_mm,
        surfaces={
            structure: surface_report(
                mesh,
                fit.unremeshed.get(structure),
                residuals[structure],
                toward_base,
                crossing[structure],
                [
                    f"{mesh_name(fit.label, structure)}.{form}"
                    for form in dict.fromkeys(options.formats)
                ],
                open_base=options.base is Base.OPEN,
            )
            for structure, mesh in fit.surfaces.items()
        },
        left_ventricle=left_ventricle_report(fit.surfaces, closed, outlines, toward_base),
        slices=[_slice(one, residuals, closed) for one in fit.slices],
        levels=[
            LevelReport(
                level=level.level,
                radius_mm=level.radius_mm,
                samples=level.samples,
                bce=level.bce,
                hinge=level.hinge,
                total=level.total,
            )
            for level in fit.levels
        ],
    )


def _slice(
    fit: SliceFit, residuals: Mapping[Structure, Sequence[Residuals]], closed: _Surfaces
) -> SliceReport:
    x, y, z = fit.shift_mm.tolist()
    own = {
        structure: [one for one in every if one.outline.slice_id == fit.id]
        for structure, every in residuals.items()
    }
    return SliceReport(
        id=fit.id,
        view=fit.view,
        shift_mm=(x, y, z),
        shift_deviation_mm=fit.shift_deviation_mm,
        crossings=fit.crossings,
        rotation_deg=math.degrees(fit.turn_rad),
        contour_residual_mm={s: summarised(all_distances_mm(r)) for s, r in own.items() if r},
        dice={s: _dice(r, closed.get(s), fit.normal) for s, r in own.items() if r},
    )


def _dice(residuals: Sequence[Residuals], mesh: SurfaceMesh | None, normal: Vector) -> float | None:
    if mesh is None:
        return None
    outlines = [one.outline for one in residuals]
    return plane_dice(mesh, outlines, outlines[0].points_mm[0], normal)


def _function(frames: Sequence[FrameReport]) -> FunctionReport | None:
    """Pump function, where end-diastole and end-systole both have a closed left endocardium."""
    by_label = {frame.label.upper(): frame for frame in frames}
    if not {"ED", "ES"} <= by_label.keys():
        return None
    ed, es = by_label["ED"], by_label["ES"]
    left = _volumes_ml(ed, es, Structure.LV_ENDO)
    if left is None:
        return None
    found = lv_function(*left).model_dump()
    areas = ed.left_ventricle.mid_area_cm2, es.left_ventricle.mid_area_cm2
    if areas[0] and areas[1] is not None:
        found["lv_fractional_area_change_percent"] = shrinkage_percent(areas[0], areas[1])
    right = _volumes_ml(ed, es, Structure.RV_ENDO)
    if right is not None:
        found |= {
            "rv_edv_ml": right[0],
            "rv_esv_ml": right[1],
            "rv_stroke_volume_ml": right[0] - right[1],
            "rv_ejection_fraction_percent": shrinkage_percent(*right),
        }
    return FunctionReport.model_validate(found)


def _volumes_ml(
    ed: FrameReport, es: FrameReport, structure: Structure
) -> tuple[float, float] | None:
    """At end-diastole and end-systole, where both frames have the surface closed."""
    both = [f.surfaces[structure].volume_ml for f in (ed, es) if structure in f.surfaces]
    return (both[0], both[1]) if len(both) == 2 and both[0] and both[1] else None
