"""A frame as the templates read it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from schemas.frame_report import FrameReport, SliceReport
from schemas.reference_report import ReferenceReport
from worker.artifacts.page.chart import Chart
from worker.artifacts.page.overlays import Panel


@dataclass(frozen=True, eq=False)
class FramePage:
    """id: begins those of its elements; labels may hold what ids may not. report: the frame in
    numbers. scene, charts, panels: what is drawn of it.
    """

    id: str
    report: FrameReport
    scene: Mapping[str, Any]
    charts: Sequence[Chart]
    panels: Sequence[Panel]

    @property
    def slices(self) -> Mapping[str, SliceReport]:
        """By their ids."""
        return {one.id: one for one in self.report.slices}

    @property
    def structures(self) -> list[str]:
        """Columns of the slices' table: what some slice of the frame observes."""
        return sorted({s for one in self.report.slices for s in one.contour_residual_mm})

    @property
    def references(self) -> Mapping[str, ReferenceReport]:
        """Of the surfaces that have one."""
        return {s: one.reference for s, one in self.report.surfaces.items() if one.reference}

    @property
    def has_curvature(self) -> bool:
        """Whether some surface's curvature was compared with its reference's."""
        return any(one.curvature for one in self.references.values())

    @property
    def has_dashes(self) -> bool:
        """Whether some panel shows a reference."""
        return any(s.kind == "reference" for panel in self.panels for s in panel.strokes)

    @property
    def held_out(self) -> bool:
        """Whether slices were left out in turn."""
        return any(one.held_out_mm for one in self.report.surfaces.values())

    @property
    def ensemble(self) -> bool:
        """Whether other seeds were tried."""
        return any(one.deviation_mm for one in self.report.surfaces.values())
