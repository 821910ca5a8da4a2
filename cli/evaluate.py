"""`neuralmri evaluate`: how far a surface is from a reference."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from cli.console import result_console, say_json
from cli.mesh_file import read_surface

if TYPE_CHECKING:
    from worker.evaluation.comparison import Comparison


def evaluate(
    mesh: Annotated[Path, typer.Argument(help="The surface to judge: STL, OBJ or PLY, in mm.")],
    reference: Annotated[Path, typer.Argument(help="The true surface, in the same frame.")],
    samples: Annotated[
        int, typer.Option(help="Points measured on either surface.", min=100, max=1_000_000)
    ] = 20_000,
    seed: Annotated[int, typer.Option(help="Seed of the sampling.", min=0)] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON for machines.")] = False,
) -> None:
    """Measure the distance between two surfaces, their volumes and their triangles.

    Distances are exact, from points spread evenly over one surface to the triangles of the other,
    both ways. The method's point-set forms are given beside them.
    """
    from worker.evaluation.comparison import compared

    comparison = compared(read_surface(mesh), read_surface(reference), samples, seed)
    if as_json:
        say_json({key: _finite(part) for key, part in asdict(comparison).items()})
        return
    for table in (_distances(comparison), _point_sets(comparison), _surfaces(comparison)):
        result_console.print(table)


def _distances(comparison: "Comparison") -> Table:
    exact = comparison.surface_distance
    table = Table("mm", "mean", "RMS", "p95", "max", title="Exact surface distance")
    for name, way in (
        ("mesh to reference", exact.to_reference),
        ("reference to mesh", exact.from_reference),
    ):
        table.add_row(name, *_numbers(way.mean_mm, way.rms_mm, way.p95_mm, way.max_mm))
    both = (exact.mean_mm, exact.rms_mm, exact.hausdorff95_mm, exact.hausdorff_mm)
    table.add_row("both", *_numbers(*both), style="bold")
    return table


def _point_sets(comparison: "Comparison") -> Table:
    points = comparison.point_set_distance
    table = Table(
        "Chamfer mm2",
        "RMS Chamfer mm",
        "Hausdorff mm",
        "HD50 mm",
        "HD90 mm",
        "HD95 mm",
        title=f"Between {comparison.samples} points on each",
        caption="not zero even for one surface: the points differ",
    )
    table.add_row(
        *_numbers(
            points.chamfer_mm2,
            points.rms_chamfer_mm,
            points.hausdorff_mm,
            points.hausdorff50_mm,
            points.hausdorff90_mm,
            points.hausdorff95_mm,
        )
    )
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


def _numbers(*values: float) -> list[str]:
    return [f"{value:.4f}" for value in values]


def _finite(value: object) -> object:
    """JSON knows no infinity (a triangle without area has that aspect ratio): null instead."""
    if isinstance(value, dict):
        return {key: _finite(part) for key, part in value.items()}
    return None if value in (float("inf"), float("-inf")) else value
