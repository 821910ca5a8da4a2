"""A report in a few lines, for a person at a terminal."""

from rich.table import Table

from cli.console import notice_console, result_console
from schemas.cycle_report import CycleReport
from schemas.report import Report


def print_summary(report: Report) -> None:
    """Surfaces as a table on standard output, warnings on standard error."""
    table = Table(title=report.subject_id, title_justify="left")
    for heading, justify in (
        ("frame", "left"),
        ("surface", "left"),
        ("volume, mL", "right"),
        ("area, cm2", "right"),
        ("closed", "left"),
        ("contour distance, mm", "right"),
        ("largest, mm", "right"),
    ):
        table.add_column(heading, justify="left" if justify == "left" else "right")
    for frame in report.frames:
        for structure, surface in frame.surfaces.items():
            table.add_row(
                frame.label,
                structure.value,
                "-" if surface.volume_ml is None else f"{surface.volume_ml:.1f}",
                f"{surface.area_cm2:.1f}",
                "yes" if surface.watertight else "no",
                f"{surface.contour_residual_mm.mean:.2f}",
                f"{surface.contour_residual_mm.max:.2f}",
            )
    result_console.print(table)
    function = report.function
    if function is not None:
        result_console.print(
            f"ejection fraction {function.lv_ejection_fraction_percent:.1f} %, "
            f"stroke volume {function.lv_stroke_volume_ml:.1f} mL "
            f"({function.ed_frame} to {function.es_frame})"
        )
    if report.cycle is not None:
        _print_cycle(report.cycle)
    for warning in report.warnings:
        notice_console.print(f"Warning: {warning}", markup=False, soft_wrap=True)


def _print_cycle(cycle: CycleReport) -> None:
    """How fast each ventricle empties and fills, a line each."""
    for structure, chamber in cycle.chambers.items():
        ejection, filling = chamber.peak_ejection_rate_ml_per_s, chamber.peak_filling_rate_ml_per_s
        if ejection is not None and filling is not None:
            result_console.print(
                f"{structure}: peak ejection {ejection:.0f} mL/s, peak filling {filling:.0f} mL/s"
            )
