"""One line of the ablation's table: a surface refined up to one level, measured."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from schemas.options import Options
from schemas.surface_name import SurfaceName
from worker.arrays import Scalars
from worker.artifacts.evidence import aligned_outlines
from worker.evaluation.comparison import closed_volume_ml, compared
from worker.evaluation.distance import points_to_surface_mm
from worker.evaluation.residuals import all_distances_mm, contour_residuals
from worker.evaluation.summary import summarised
from worker.reconstruction.result import FrameFit
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True)
class ReferenceErrors:
    """A surface held against its reference, as they lie.

    mean_mm, rms_mm, hausdorff95_mm, hausdorff_mm: exact, both ways, as of `surface_to_surface`.
    point_set_*: the method's own measures, as of `point_set_distance`.
    *_curvature_mean_abs_*: reference minus surface, both remeshed to `reference.curvature_edge_mm`;
        None where that is null, or one of them is open. volume_difference_percent: None likewise.
    """

    mean_mm: float
    rms_mm: float
    hausdorff95_mm: float
    hausdorff_mm: float
    point_set_chamfer_mm2: float
    point_set_hausdorff_mm: float
    volume_difference_percent: float | None
    gaussian_curvature_mean_abs_per_mm2: float | None
    mean_curvature_mean_abs_per_mm: float | None


@dataclass(frozen=True)
class AblationRow:
    """One surface of one frame, refined up to `level`.

    radius_mm: how near to the contours that level sampled. iterations: of the whole fit.
    contour_residual_*: exact distances from the observed, aligned contours to the surface.
    volume_ml: None where the surface is open.
    """

    level: int
    iterations: int
    radius_mm: float
    frame: str
    surface: str
    contour_residual_mean_mm: float
    contour_residual_p95_mm: float
    volume_ml: float | None
    reference: ReferenceErrors | None


@dataclass(frozen=True, eq=False)
class AblatedSurface:
    """A row of the table, its surface, mm, the study's axes, and where there is a reference the
    exact distance to it of every vertex, (n,) mm.
    """

    row: AblationRow
    mesh: SurfaceMesh
    distance_mm: Scalars | None


def measured_level(
    level: int, frame: FrameFit, options: Options, references: Mapping[str, SurfaceMesh]
) -> Iterator[AblatedSurface]:
    """The surfaces of a frame whose fit, by `options`, ended with `level`.

    references: by name (`schemas.surface_name`), mm, in the frame's axes. Raises InternalError for
    a surface without contours.
    """
    outlines = aligned_outlines(frame)
    for structure, mesh in frame.surfaces.items():
        residual = summarised(
            all_distances_mm(contour_residuals(mesh, outlines.get(structure, ())))
        )
        reference = references.get(str(SurfaceName(frame.label, structure)))
        row = AblationRow(
            level=level,
            iterations=options.levels * options.iterations_per_level,
            radius_mm=frame.levels[-1].radius_mm,
            frame=frame.label,
            surface=structure.value,
            contour_residual_mean_mm=residual.mean,
            contour_residual_p95_mm=residual.p95,
            volume_ml=closed_volume_ml(mesh),
            reference=None if reference is None else _errors(mesh, reference, options),
        )
        distance_mm = (
            None if reference is None else points_to_surface_mm(mesh.vertices_mm, reference)
        )
        yield AblatedSurface(row, mesh, distance_mm)


def _errors(mesh: SurfaceMesh, reference: SurfaceMesh, options: Options) -> ReferenceErrors:
    chosen = options.reference
    found = compared(mesh, reference, chosen.samples, curvature_edge_mm=chosen.curvature_edge_mm)
    exact, points, bend = found.surface_distance, found.point_set_distance, found.curvature
    return ReferenceErrors(
        mean_mm=exact.mean_mm,
        rms_mm=exact.rms_mm,
        hausdorff95_mm=exact.hausdorff95_mm,
        hausdorff_mm=exact.hausdorff_mm,
        point_set_chamfer_mm2=points.chamfer_mm2,
        point_set_hausdorff_mm=points.hausdorff_mm,
        volume_difference_percent=found.volume_difference_percent,
        gaussian_curvature_mean_abs_per_mm2=bend.gaussian_per_mm2.mean_abs if bend else None,
        mean_curvature_mean_abs_per_mm=bend.mean_per_mm.mean_abs if bend else None,
    )
