"""All charts of a frame."""

from schemas.frame_report import FrameReport
from worker.artifacts.measured import MeasuredFrame
from worker.artifacts.page.bullseye import thickness_chart
from worker.artifacts.page.chart import Chart
from worker.artifacts.page.histograms import distance_chart, residual_chart
from worker.artifacts.page.losses import loss_chart


def charts(report: FrameReport, frame: MeasuredFrame, hinge_weight: float) -> list[Chart]:
    """Those that the frame has something to show in, errors first."""
    distances = [
        distance_chart(structure.value, surface.fields["distance_mm"])
        for structure, surface in frame.surfaces.items()
        if "distance_mm" in surface.fields
    ]
    residuals = [
        residual_chart(structure.value, surface.contour_residual_by_view)
        for structure, surface in report.surfaces.items()
    ]
    wall = thickness_chart(report.left_ventricle.wall_thickness_mm)
    fit = loss_chart(report.levels, hinge_weight)
    return [one for one in (*distances, *residuals, wall, fit) if one is not None]
