"""One frame of a reconstruction, measured: every surface and slice of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from schemas.frame_report import FrameReport, LevelReport, LossCurves
from schemas.measures import DistanceSummary
from schemas.options import Base, Options
from schemas.reference_report import ReferenceReport
from schemas.surface_name import SurfaceName
from schemas.vocabulary import Structure
from worker.arrays import SomeScalars, Vector
from worker.artifacts.evidence import aligned_outlines
from worker.artifacts.held_out import HeldOut, held_out_distances
from worker.artifacts.left_ventricle import left_ventricle_report, ventricle_place
from worker.artifacts.measured import MeasuredFrame, MeasuredSurface
from worker.artifacts.reference_planes import ViewPlane
from worker.artifacts.reference_report import MeasuredReference, reference_report
from worker.artifacts.slice_report import (
    cut_by,
    own_residuals,
    plane_origin_mm,
    slice_report,
)
from worker.artifacts.surface_crossings import crossing_triangles
from worker.artifacts.surface_report import surface_report
from worker.artifacts.vertex_fields import vertex_fields
from worker.evaluation.aha_segments import LeftVentricle
from worker.evaluation.extrapolation import apex_to_base
from worker.evaluation.regions import regions
from worker.evaluation.residuals import contour_residuals
from worker.evaluation.summary import summarised
from worker.evaluation.topology import is_watertight
from worker.observer import Cancelled, Observer
from worker.reconstruction.result import FrameFit, LevelFit
from worker.surface_mesh import SurfaceMesh

_DIGITS = 6
"""Of a loss in the report: a float32 has no more."""

Surfaces = Mapping[Structure, SurfaceMesh]


def measured_frame(
    fit: FrameFit, options: Options, references: Surfaces, observer: Observer
) -> tuple[FrameReport, MeasuredFrame]:
    """Measure one frame. references: of its surfaces, mm, the study's axes, those there are.

    Raises InternalError for a surface that faces inward, or that no contour was observed of;
    Cancelled when the observer, asked at each surface, says so.
    """
    outlines = aligned_outlines(fit)
    toward_base = apex_to_base(outlines)
    closed = {s: mesh for s, mesh in fit.surfaces.items() if is_watertight(mesh)}
    place = ventricle_place(fit.surfaces, outlines, toward_base)
    ventricle = place if isinstance(place, LeftVentricle) else None
    planes = [(one.view, plane_origin_mm(one), one.normal) for one in fit.slices]
    found = {}
    for structure, mesh in fit.surfaces.items():
        if observer.is_cancelled():
            raise Cancelled
        residuals = contour_residuals(mesh, outlines.get(structure, ()))
        against = _against(fit, structure, references, planes, toward_base, options, observer)
        reference = against.reference if against else None
        fields = vertex_fields(fit, structure, residuals, toward_base, ventricle, reference)
        found[structure] = _Found(MeasuredSurface(mesh, fields, residuals, reference), against)
    held_out = held_out_distances(fit, outlines)
    crossing = crossing_triangles(fit.surfaces)
    surfaces = {structure: one.surface for structure, one in found.items()}
    cuts = [
        cut_by(one, fit.surfaces, {s: m.reference for s, m in surfaces.items() if m.reference})
        for one in fit.slices
    ]
    residuals_of = {structure: one.residuals for structure, one in surfaces.items()}
    report = FrameReport(
        label=fit.label,
        time_ms=fit.time_ms,
        started_from=fit.started_from,
        contour_noise_mm=fit.contour_noise_mm,
        surfaces={
            structure: surface_report(
                one.surface,
                fit.unremeshed.get(structure),
                toward_base,
                crossing[structure],
                held_out[structure],
                one.report,
                _files(fit.label, structure, options),
                open_base=options.base is Base.OPEN,
            )
            for structure, one in found.items()
        },
        left_ventricle=left_ventricle_report(fit.surfaces, closed, toward_base, place),
        slices=[
            slice_report(
                one, own_residuals(one.id, residuals_of), cut, list(closed), _of(one.id, held_out)
            )
            for one, cut in zip(fit.slices, cuts, strict=True)
        ],
        levels=[_level(one) for one in fit.levels],
    )
    return report, MeasuredFrame(fit.label, surfaces, cuts, ventricle)


@dataclass(frozen=True, eq=False)
class _Found:
    surface: MeasuredSurface
    against: MeasuredReference | None

    @property
    def report(self) -> ReferenceReport | None:
        return self.against.report if self.against else None


def _against(
    fit: FrameFit,
    structure: Structure,
    references: Surfaces,
    planes: Sequence[ViewPlane],
    toward_base: Vector | None,
    options: Options,
    observer: Observer,
) -> MeasuredReference | None:
    if structure not in references:
        return None
    return reference_report(
        fit.surfaces[structure],
        references[structure],
        regions=regions(structure, fit.surfaces, toward_base),
        planes=planes,
        options=options.reference,
        seed=options.seed,
        observer=observer,
    )


def _files(label: str, structure: Structure, options: Options) -> list[str]:
    return [f"{SurfaceName(label, structure)}.{form}" for form in dict.fromkeys(options.formats)]


def _of(
    slice_id: str, held_out: Mapping[Structure, Sequence[HeldOut]]
) -> dict[Structure, DistanceSummary]:
    return {
        structure: summarised(one.distances_mm)
        for structure, every in held_out.items()
        for one in every
        if one.slice_id == slice_id
    }


def _level(fit: LevelFit) -> LevelReport:
    return LevelReport(
        level=fit.level,
        radius_mm=fit.radius_mm,
        samples=fit.samples,
        bce=float(fit.bce.mean()),
        hinge=float(fit.hinge.mean()),
        total=float(fit.total.mean()),
        iterations=LossCurves(
            bce=_rounded(fit.bce), hinge=_rounded(fit.hinge), total=_rounded(fit.total)
        ),
    )


def _rounded(losses: SomeScalars) -> list[float]:
    return [float(f"{loss:.{_DIGITS}g}") for loss in losses]
