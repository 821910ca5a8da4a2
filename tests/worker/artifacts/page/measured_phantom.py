"""The phantom as if it had been reconstructed: surfaces by formula, fields by formula."""

from collections.abc import Sequence

import numpy as np

from intake.planes import slice_plane
from schemas.report import Report
from schemas.study import Frame, Slice
from schemas.vocabulary import Structure, View
from tests.worker.artifacts.page.example_report import (
    distances,
    frame_report,
    reference_report,
    report,
    slice_report,
    surface_report,
)
from worker.artifacts.measured import Measured, MeasuredFrame, MeasuredSlice, MeasuredSurface
from worker.evaluation.curvature import vertex_curvature
from worker.evaluation.residuals import contour_residuals
from worker.evaluation.section import section
from worker.evaluation.support import AlignedOutline, distance_to_outlines_mm
from worker.phantom.analytic_heart import heart
from worker.phantom.standard_study import standard_study
from worker.surface_mesh import SurfaceMesh


def measured_phantom(
    labels: Sequence[str] = ("ED",), *, edge_mm: float = 3.0, reference: bool = True
) -> Measured:
    """One frame for each label, from full to empty."""
    phases = {label: n / max(1, len(labels) - 1) for n, label in enumerate(labels)}
    study = standard_study(phases, edge_mm=2.0)
    frames, reports = [], []
    for frame in study.frames:
        meshes = heart(phases[frame.label]).meshes(edge_mm)
        frames.append(_frame(frame, meshes, reference))
        reports.append(_report(frame, frames[-1], reference))
    whole: Report = report(*reports)
    return Measured(whole, frames)


def _frame(frame: Frame, meshes: dict[Structure, SurfaceMesh], reference: bool) -> MeasuredFrame:
    moved = {
        s: SurfaceMesh(m.vertices_mm + np.array([0.0, 1.5, 0.0]), m.faces)
        for s, m in meshes.items()
    }
    return MeasuredFrame(
        label=frame.label,
        surfaces={
            s: _surface(m, _outlines(frame, s), moved[s] if reference else None)
            for s, m in meshes.items()
        },
        slices=[_slice(one, meshes, moved if reference else {}) for one in frame.slices],
    )


def _outlines(frame: Frame, structure: Structure) -> list[AlignedOutline]:
    return [
        AlignedOutline(one.id, one.view, np.array(c.points), c.closed)
        for one in frame.slices
        for c in one.contours
        if c.structure == structure
    ]


def _surface(
    mesh: SurfaceMesh, outlines: Sequence[AlignedOutline], reference: SurfaceMesh | None
) -> MeasuredSurface:
    curvature = vertex_curvature(mesh)
    height = mesh.vertices_mm[:, 2]
    along = (height - height.min()) / np.ptp(height)
    fields = {
        "support_mm": distance_to_outlines_mm(mesh.vertices_mm, outlines),
        "residual_mm": np.abs(np.sin(height / 9.0)),
        "gaussian_curvature_per_mm2": curvature.gaussian_per_mm2,
        "mean_curvature_per_mm": curvature.mean_per_mm,
        "thickness_mm": np.where(along < 0.9, 8.0 + 3.0 * along, np.nan),
        "third": np.floor(along * 2.99),
        "aha_segment": np.floor(along * 17.99),
    }
    if reference is not None:
        fields["distance_mm"] = 1.5 * along
    return MeasuredSurface(mesh, fields, contour_residuals(mesh, outlines), reference)


def _slice(
    one: Slice,
    meshes: dict[Structure, SurfaceMesh],
    references: dict[Structure, SurfaceMesh],
) -> MeasuredSlice:
    plane = slice_plane(one, 1.0)

    def cut(parts: dict[Structure, SurfaceMesh]) -> dict[Structure, list[np.ndarray]]:
        return {
            s: [np.concatenate([x, x[:1]]) for x in section(m, plane.origin, plane.normal)]
            for s, m in parts.items()
        }

    return MeasuredSlice(one.id, one.view, plane.origin, plane.normal, cut(meshes), cut(references))


def _report(frame: Frame, measured: MeasuredFrame, reference: bool):
    seen = {one.id: {c.structure for c in one.contours} for one in frame.slices}
    return frame_report(
        frame.label,
        surfaces={
            s: surface_report(
                files=[f"{frame.label}_{s}.stl", f"{frame.label}_{s}.vtp"],
                reference=reference_report() if reference else None,
            )
            for s in measured.surfaces
        },
        slices=[
            slice_report(
                one.id,
                one.view,
                contour_residual_mm={
                    s: distances(0.2 + n / 7) for n, s in enumerate(sorted(seen[one.id]))
                },
                dice={s: 0.99 - n / 50 for n, s in enumerate(sorted(seen[one.id]))},
                shift_deviation_mm=0.4 if one.view is View.SAX else None,
            )
            for one in frame.slices
        ],
    )
