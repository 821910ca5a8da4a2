"""An ablation in one table a surface, for a person at a terminal."""

from collections.abc import Iterable, Sequence
from itertools import groupby
from operator import attrgetter
from typing import TYPE_CHECKING

from rich.box import SIMPLE
from rich.table import Table

from cli.console import result_console

if TYPE_CHECKING:
    from worker.ablation_row import AblationRow

_OWN = ("\nlevel", "contour\nmm", "p95\nmm", "volume\nmL")
_HELD = ("mean\nmm", "RMS\nmm", "HD95\nmm", "HD\nmm", "Chamfer\nmm2", "Hausdorff\nmm")


def print_ablation(rows: Iterable["AblationRow"]) -> None:
    """Tables on standard output: distances of contours, and where there is a reference the exact
    distances to it and the method's point-set ones.
    """
    surface = attrgetter("frame", "surface")
    # Sorting keeps the order of levels.
    for (frame, structure), some in groupby(sorted(rows, key=surface), surface):
        result_console.print(_table(f"{frame}_{structure}", list(some)))


def _table(name: str, rows: Sequence["AblationRow"]) -> Table:
    held = any(row.reference for row in rows)
    # Narrow enough for 80 columns: radii are in the file.
    table = Table(
        title=name, title_justify="left", box=SIMPLE, padding=(0, 1, 0, 0), pad_edge=False
    )
    for heading in (*_OWN, *(_HELD if held else ())):
        table.add_column(heading, justify="right")
    for row in rows:
        table.add_row(str(row.level), *_own(row), *_held(row))
    return table


def _own(row: "AblationRow") -> list[str]:
    return [
        f"{row.contour_residual_mean_mm:.3f}",
        f"{row.contour_residual_p95_mm:.3f}",
        "-" if row.volume_ml is None else f"{row.volume_ml:.1f}",
    ]


def _held(row: "AblationRow") -> list[str]:
    if row.reference is None:
        return []
    held = row.reference
    return [
        f"{value:.3f}"
        for value in (
            held.mean_mm,
            held.rms_mm,
            held.hausdorff95_mm,
            held.hausdorff_mm,
            held.point_set_chamfer_mm2,
            held.point_set_hausdorff_mm,
        )
    ]
