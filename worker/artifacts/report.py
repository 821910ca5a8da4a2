"""The report: every surface and slice of a reconstruction, measured."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from schemas.options import Options
from schemas.report import (
    DistanceSummary,
    FrameReport,
    FunctionReport,
    LevelReport,
    Provenance,
    Report,
    SliceReport,
)
from schemas.vocabulary import MeshFormat, Structure
from worker.arrays import Scalars
from worker.artifacts.evidence import aligned_outlines
from worker.artifacts.outline_warnings import outline_warnings
from worker.artifacts.support_warnings import support_warnings
from worker.artifacts.surface_report import surface_report
from worker.evaluation.distance import points_to_surface_mm
from worker.evaluation.extrapolation import apex_to_base
from worker.evaluation.function import lv_function
from worker.evaluation.summary import summarised
from worker.reconstruction.result import FrameFit, Reconstruction, SliceFit
from worker.surface_mesh import SurfaceMesh

_Residuals = Mapping[Structure, Scalars]


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
    frames = [_frame(fit, options.formats) for fit in reconstruction.frames]
    return Report(
        subject_id=reconstruction.subject_id,
        axes=reconstruction.axes,
        frames=frames,
        function=_function(frames),
        warnings=[
            *warnings,
            *(text for one in frames for text in outline_warnings(one.label, one.outline_noise_mm)),
            *(text for one in frames for text in support_warnings(one.label, one.surfaces)),
        ],
        timings_s=dict(timings_s),
        options=options,
        provenance=provenance,
    )


def mesh_name(frame_label: str, structure: Structure) -> str:
    """What a surface is called, as a file and inside it: `ED_lv_endo`."""
    return f"{frame_label}_{structure}"


def _frame(fit: FrameFit, formats: Sequence[MeshFormat]) -> FrameReport:
    residuals = [_residuals(one, fit.surfaces) for one in fit.slices]
    outlines = aligned_outlines(fit)
    toward_base = apex_to_base(outlines)
    return FrameReport(
        label=fit.label,
        time_ms=fit.time_ms,
        outline_noise_mm=fit.outline_noise_mm,
        surfaces={
            structure: surface_report(
                mesh,
                fit.unremeshed.get(structure),
                _joined([r[structure] for r in residuals if structure in r]),
                outlines.get(structure, ()),
                toward_base,
                [f"{mesh_name(fit.label, structure)}.{form}" for form in dict.fromkeys(formats)],
            )
            for structure, mesh in fit.surfaces.items()
        },
        slices=[_slice(one, r) for one, r in zip(fit.slices, residuals, strict=True)],
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


def _slice(fit: SliceFit, residuals: _Residuals) -> SliceReport:
    x, y, z = fit.shift_mm.tolist()
    summaries: dict[Structure, DistanceSummary] = {
        structure: summarised(distances_mm) for structure, distances_mm in residuals.items()
    }
    return SliceReport(
        id=fit.id,
        view=fit.view,
        shift_mm=(x, y, z),
        shift_deviation_mm=fit.shift_deviation_mm,
        crossings=fit.crossings,
        rotation_deg=math.degrees(fit.turn_rad),
        contour_residual_mm=summaries,
    )


def _residuals(fit: SliceFit, surfaces: Mapping[Structure, SurfaceMesh]) -> _Residuals:
    """Distances of one slice's outlines to the surfaces that were made of them, mm."""
    return {
        structure: np.concatenate(
            [
                points_to_surface_mm(fit.aligned_mm(outline.points_mm), surfaces[structure])
                for outline in outlines
            ]
        )
        for structure, outlines in fit.contours_mm.items()
        if structure in surfaces and outlines
    }


def _joined(parts: Sequence[np.ndarray]) -> np.ndarray:
    """One (n,) array of many, each of its own length."""
    return np.concatenate(parts) if parts else np.empty(0)


def _function(frames: Sequence[FrameReport]) -> FunctionReport | None:
    """Pump function, where end-diastole and end-systole both have a closed endocardium."""
    volumes_ml = {
        frame.label.upper(): frame.surfaces[Structure.LV_ENDO].volume_ml
        for frame in frames
        if Structure.LV_ENDO in frame.surfaces
    }
    edv_ml, esv_ml = volumes_ml.get("ED"), volumes_ml.get("ES")
    return lv_function(edv_ml, esv_ml) if edv_ml and esv_ml else None
