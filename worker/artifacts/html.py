"""`report.html`: the report as one page that needs no network, no script and no other file."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from jinja2 import Environment, PackageLoader, StrictUndefined

from schemas.report import FrameReport, LevelReport, Report

_CHART_WIDTH = 320
_CHART_HEIGHT = 120
_CHART_MARGIN = 14

_PAGES = Environment(
    loader=PackageLoader("worker.artifacts", package_path=""),
    autoescape=True,
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)


@dataclass(frozen=True)
class LossChart:
    """Positions of a polyline over the levels, in SVG user units; loss on a logarithmic axis."""

    width: int
    height: int
    marks: tuple[tuple[float, float], ...]

    @property
    def polyline(self) -> str:
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in self.marks)


def render_html(report: Report) -> str:
    """The page. Every text in it is escaped; numbers are rounded for reading, not for reuse."""
    page = _PAGES.get_template("report.html.j2")
    charts = {frame.label: loss_chart(frame.levels) for frame in report.frames}
    return page.render(report=report, charts=charts, structures_of=_structures_of)


def loss_chart(levels: Sequence[LevelReport]) -> LossChart:
    """Total loss against level, higher loss higher up; a loss of zero is drawn at the lowest."""
    positive = [level.total for level in levels if level.total > 0]
    low, high = (math.log(min(positive)), math.log(max(positive))) if positive else (0.0, 0.0)
    width, height = _CHART_WIDTH - 2 * _CHART_MARGIN, _CHART_HEIGHT - 2 * _CHART_MARGIN
    marks = []
    for index, level in enumerate(levels):
        across = index / max(1, len(levels) - 1)
        up = (math.log(level.total) - low) / (high - low) if level.total > 0 and high > low else 0.0
        marks.append((_CHART_MARGIN + across * width, _CHART_MARGIN + (1 - up) * height))
    return LossChart(_CHART_WIDTH, _CHART_HEIGHT, tuple(marks))


def _structures_of(frame: FrameReport) -> list[str]:
    """The columns of a slice table: every structure that some slice of the frame observes."""
    return sorted({structure for one in frame.slices for structure in one.contour_residual_mm})
