"""A measured reconstruction: the report, and what is drawn and written beside it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from schemas.report import Report
from schemas.vocabulary import Structure, View
from worker.arrays import SomePoints, SomeScalars, Vector
from worker.evaluation.aha_segments import LeftVentricle
from worker.evaluation.residuals import Residuals
from worker.surface_mesh import SurfaceMesh
from worker.tracking.tracked_surface import TrackedSurface

FIELDS = {
    "support_mm": "distance to the nearest contour of the surface",
    "residual_mm": "how far the nearest contour point is from the surface",
    "gaussian_curvature_per_mm2": "Gaussian curvature of the field's level set",
    "mean_curvature_per_mm": "mean curvature of the field's level set, positive where convex",
    "thickness_mm": "of the left ventricle's wall",
    "third": "0 apex, 1 mid, 2 base: thirds of the extent along the short-axis normal",
    "aha_segment": "1 to 17 as the American Heart Association numbers them, 0 above the base",
    "distance_mm": "to the reference",
    "deviation_mm": "standard deviation over the fits of the ensemble, along the normal",
    "area_strain": "growth of the area about the vertex since the report's cycle.ed_frame, 0.1 for "
    "10 percent; its spread over the surface is not observed",
}
"""Numbers at the vertices of a surface, those there are, by name: what they say."""


@dataclass(frozen=True, eq=False)
class MeasuredSurface:
    """A surface, mm, and what is known at its vertices and contour points.

    fields: by a name of FIELDS, (vertices,) each. residuals: of every outline that it was observed
        by, moved back by its slice's motion. reference: what it was held against, if anything.
    """

    mesh: SurfaceMesh
    fields: Mapping[str, SomeScalars]
    residuals: Sequence[Residuals]
    reference: SurfaceMesh | None


@dataclass(frozen=True, eq=False)
class MeasuredSlice:
    """A slice's plane after alignment, and both kinds of contours on it, patient mm.

    origin_mm, normal: (3,) each. sections: where the surfaces cross the plane, per structure
    polylines (k, 3), closed by repeating the first point, open where the surface is. The observed
    outlines are in the residuals of the surfaces, by `slice_id`.
    """

    id: str
    view: View
    origin_mm: Vector
    normal: Vector
    sections: Mapping[Structure, Sequence[SomePoints]]
    reference_sections: Mapping[Structure, Sequence[SomePoints]]


@dataclass(frozen=True, eq=False)
class MeasuredFrame:
    """One instant of the cycle; the report has it under the same label.

    ventricle: where the left one lies, None where its segments cannot be told apart.
    """

    label: str
    surfaces: Mapping[Structure, MeasuredSurface]
    slices: Sequence[MeasuredSlice]
    ventricle: LeftVentricle | None = None

    def with_meshes(self, meshes: Mapping[Structure, SurfaceMesh]) -> "MeasuredFrame":
        """The same with these very meshes in place of their copies, which another process made."""
        surfaces = {s: replace(one, mesh=meshes[s]) for s, one in self.surfaces.items()}
        return replace(self, surfaces=surfaces)


@dataclass(frozen=True, eq=False)
class Measured:
    """Everything about one subject. tracked: the surfaces that were carried through the frames."""

    report: Report
    frames: Sequence[MeasuredFrame]
    tracked: Mapping[Structure, TrackedSurface] = field(default_factory=dict)
