"""`neuralmri evaluate`: how far a surface is from a reference."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from cli.console import result_console, say_json
from schemas.problem import InputError, ProblemType

if TYPE_CHECKING:
    from worker.evaluation.comparison import Comparison
    from worker.evaluation.curvature_comparison import CurvatureComparison
    from worker.evaluation.distance import SurfaceDistance
    from worker.evaluation.point_set_distance import PointSetDistance
    from worker.evaluation.rigid_placement import RigidPlacement
    from worker.surface_mesh import SurfaceMesh


def evaluate(
    mesh: Annotated[Path, typer.Argument(help="The surface to judge: STL, OBJ or PLY, in mm.")],
    reference: Annotated[Path, typer.Argument(help="The true surface, in the same frame.")],
    samples: Annotated[
        int, typer.Option(help="Points measured on either surface.", min=100, max=1_000_000)
    ] = 20_000,
    seed: Annotated[int, typer.Option(help="Seed of the sampling.", min=0)] = 0,
    curvature_edge_mm: Annotated[
        float | None,
        typer.Option(
            help="Compare how both surfaces bend, too, remeshed to this edge length in mm.",
            min=0.5,
            max=10.0,
        ),
    ] = None,
    align: Annotated[
        bool,
        typer.Option(
            "--align",
            help="Lay the mesh rigidly onto the reference first, and say by which motion. Hides "
            "what is displaced or turned as a whole.",
        ),
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON for machines.")] = False,
) -> None:
    """Measure the distance between two surfaces, their volumes and their triangles.

    Distances are exact, from points spread evenly over one surface to the triangles of the other,
    both ways. The method's point-set forms are given beside them, and on request curvature.
    """
    from worker.evaluation.comparison import compared
    from worker.mesh_file import read_surface

    own, other = read_surface(mesh), read_surface(reference)
    placement = _placement(own, other) if align else None
    if placement is not None:
        own = placement.moved(own)
    comparison = compared(own, other, samples, seed, curvature_edge_mm)
    if as_json:
        measured = {key: _finite(part) for key, part in asdict(comparison).items()}
        say_json(measured | {"placement": _motion(placement)})
        return
    if placement is not None:
        x, y, z = placement.translation_mm
        result_console.print(
            f"Laid onto the reference: turned by {placement.rotation_deg:.3f} degrees, its "
            f"centroid moved by ({x:.3f}, {y:.3f}, {z:.3f}) mm."
        )
    for table in (
        _distances(comparison),
        _point_sets(comparison),
        _directed_point_sets(comparison),
        _surfaces(comparison),
    ):
        result_console.print(table)
    if comparison.curvature is not None:
        result_console.print(_curvature(comparison.curvature))
    elif curvature_edge_mm is not None:
        result_console.print("Curvature is not compared: both surfaces must be closed.")


def _placement(mesh: "SurfaceMesh", reference: "SurfaceMesh") -> "RigidPlacement":
    from worker.evaluation.rigid_placement import rigid_placement
    from worker.evaluation.size import area_cm2

    for name, one in (("mesh", mesh), ("reference", reference)):
        if not area_cm2(one) > 0.0:
            raise InputError(
                ProblemType.INVALID_REQUEST,
                f"The {name} has no triangle with area; export the surface again.",
            )
    return rigid_placement(mesh, reference)


def _motion(placement: "RigidPlacement | None") -> dict[str, object] | None:
    if placement is None:
        return None
    return {
        "rotation_deg": placement.rotation_deg,
        "translation_mm": placement.translation_mm.tolist(),
    }


def _distances(comparison: "Comparison") -> Table:
    exact = comparison.surface_distance
    table = _both_ways("Exact surface distance", exact)
    both = (exact.mean_mm, exact.rms_mm, exact.hausdorff95_mm, exact.hausdorff_mm)
    table.add_row("both", *_numbers(*both), style="bold")
    return table


def _directed_point_sets(comparison: "Comparison") -> Table:
    return _both_ways("Directed distances between these points", comparison.point_set_distance)


def _both_ways(title: str, found: "SurfaceDistance | PointSetDistance") -> Table:
    table = Table("mm", "mean", "RMS", "p95", "max", title=title)
    for name, way in (
        ("mesh to reference", found.to_reference),
        ("reference to mesh", found.from_reference),
    ):
        table.add_row(name, *_numbers(way.mean_mm, way.rms_mm, way.p95_mm, way.max_mm))
    return table


def _point_sets(comparison: "Comparison") -> Table:
    points = comparison.point_set_distance
    table = Table(
        "",
        "",
        title=f"Between {comparison.samples} points on each",
        caption="not zero even for one surface: the points differ",
        show_header=False,
    )
    for name, value in (
        ("Chamfer mm2", points.chamfer_mm2),
        ("RMS Chamfer mm", points.rms_chamfer_mm),
        ("Hausdorff mm", points.hausdorff_mm),
        ("HD50 mm", points.hausdorff50_mm),
        ("HD90 mm", points.hausdorff90_mm),
        ("HD95 mm", points.hausdorff95_mm),
        ("RMSE mm", points.rmse_mm),
        ("MAE mm", points.mae_mm),
        ("optimal threshold mm", points.optimal_threshold_mm),
    ):
        table.add_row(name, *_numbers(value))
    return table


def _surfaces(comparison: "Comparison") -> Table:
    table = Table("", "mesh", "reference", title="Surfaces")
    pair = (comparison.mesh, comparison.reference)
    closed = [f"{s.volume_ml:.3f}" if s.volume_ml is not None else "open" for s in pair]
    table.add_row("volume mL", *closed)
    table.add_row("area cm2", *(f"{s.area_cm2:.3f}" for s in pair))
    table.add_row("watertight", *("yes" if s.watertight else "no" for s in pair))
    table.add_row("Euler number", *(str(s.euler_number) for s in pair))
    table.add_row("components", *(str(s.components) for s in pair))
    table.add_row("faces", *(str(s.faces) for s in pair))
    table.add_row("faces under 20 deg %", *(f"{s.quality.below_20_deg_percent:.1f}" for s in pair))
    if comparison.volume_difference_percent is not None:
        table.add_row("volume difference %", f"{comparison.volume_difference_percent:+.3f}", "")
    return table


def _curvature(found: "CurvatureComparison") -> Table:
    table = Table(
        "reference minus mesh",
        "Gaussian, 1/mm2",
        "mean, 1/mm",
        title=f"Curvature, both with edges of {found.edge_mm:g} mm",
    )
    both = found.gaussian_per_mm2, found.mean_per_mm
    for name, values in (
        ("mean of amounts", [part.mean_abs for part in both]),
        ("RMS", [part.rms for part in both]),
        ("75th percentile", [part.p75_abs for part in both]),
        ("90th percentile", [part.p90_abs for part in both]),
        ("reference's own RMS", [part.reference_rms for part in both]),
    ):
        table.add_row(name, *(f"{value:.5f}" for value in values))
    areas = (f"{part.above_p75_area_percent:.1f}" for part in both)
    table.add_row("area above the 75th, %", *areas)
    return table


def _numbers(*values: float) -> list[str]:
    return [f"{value:.4f}" for value in values]


def _finite(value: object) -> object:
    """JSON knows no infinity (a triangle without area has that aspect ratio): null instead."""
    if isinstance(value, dict):
        return {key: _finite(part) for key, part in value.items()}
    return None if value in (float("inf"), float("-inf")) else value
