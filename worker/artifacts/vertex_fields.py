"""What is known at the vertices of a surface, by the names of `measured.FIELDS`."""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.spatial import cKDTree

from schemas.vocabulary import Structure
from worker.arrays import SomeScalars, Vector
from worker.evaluation.aha_segments import LeftVentricle, aha_segments
from worker.evaluation.distance import vertices_to_surface_mm
from worker.evaluation.residuals import Residuals, all_distances_mm
from worker.evaluation.spread import vertex_deviation_mm
from worker.evaluation.support import distance_to_outlines_mm
from worker.evaluation.thirds import thirds
from worker.reconstruction.result import FrameFit
from worker.surface_mesh import SurfaceMesh

Fields = Mapping[str, SomeScalars]

_WALL = {Structure.LV_ENDO: Structure.LV_EPI, Structure.LV_EPI: Structure.LV_ENDO}
"""The other side of the left ventricle's wall."""


def vertex_fields(
    fit: FrameFit,
    structure: Structure,
    residuals: Sequence[Residuals],
    toward_base: Vector | None,
    ventricle: LeftVentricle | None,
    reference: SurfaceMesh | None,
) -> Fields:
    """Of one surface of a frame, (vertices,) each; what cannot be known is left out.

    toward_base: (3,) the short-axis normal from apex to base. ventricle: the left one. reference:
    what the surface is held against, where it is compared, mm.
    Raises InternalError for a surface that no contour was observed of.
    """
    mesh = fit.surfaces[structure]
    fields = {
        "support_mm": distance_to_outlines_mm(mesh.vertices_mm, [one.outline for one in residuals]),
        "residual_mm": _nearest_residual_mm(mesh, residuals),
    }
    if structure in fit.curvature:
        curvature = fit.curvature[structure]
        fields["gaussian_curvature_per_mm2"] = curvature.gaussian_per_mm2
        fields["mean_curvature_per_mm"] = curvature.mean_per_mm
    if structure in _WALL and _WALL[structure] in fit.surfaces:
        fields["thickness_mm"] = vertices_to_surface_mm(mesh, fit.surfaces[_WALL[structure]])
    if toward_base is not None:
        fields["third"] = thirds(mesh, toward_base).of(mesh.vertices_mm).astype(np.float64)
    if structure in _WALL and ventricle is not None:
        fields["aha_segment"] = aha_segments(mesh.vertices_mm, ventricle).astype(np.float64)
    if reference is not None:
        fields["distance_mm"] = vertices_to_surface_mm(mesh, reference)
    members = [one[structure] for one in fit.members if structure in one]
    if members:
        fields["deviation_mm"] = vertex_deviation_mm(mesh, members)
    return fields


def _nearest_residual_mm(mesh: SurfaceMesh, residuals: Sequence[Residuals]) -> SomeScalars:
    """At each vertex the residual of the contour point that is nearest to it."""
    points = np.concatenate([one.outline.points_mm for one in residuals])
    _, nearest = cKDTree(points).query(mesh.vertices_mm)
    return all_distances_mm(residuals)[nearest]
