"""The whole cycle as the templates read it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from schemas.cycle_report import CycleReport
from schemas.report import FunctionReport
from schemas.vocabulary import Structure
from worker.artifacts.frame_times import FrameTimes, frame_times
from worker.artifacts.measured import Measured
from worker.artifacts.moving_surface import MovingSurface, moving_surfaces
from worker.artifacts.page.chart import Chart
from worker.artifacts.page.cycle_charts import cycle_charts
from worker.artifacts.page.cycle_scene import cycle_scene
from worker.artifacts.page.frame_page import FramePage
from worker.tracked_meshes import FEWEST_FRAMES
from worker.tracking.tracked_surface import NOT_OBSERVED


@dataclass(frozen=True, eq=False)
class CyclePage:
    """id: begins those of its elements. report: the cycle in numbers, None where it was not
    measured. scene: what the player draws, None where no surface moves. charts: over time.
    """

    id: str
    report: CycleReport | None
    times: FrameTimes
    moving: Sequence[MovingSurface]
    scene: Mapping[str, Any] | None
    charts: Sequence[Chart]

    @property
    def tracked(self) -> list[str]:
        """Surfaces that are shown as the tracked mesh."""
        return [one.structure.value for one in self.moving if one.is_tracked]

    def tells(self, function: FunctionReport) -> bool:
        """Whether the table of the ventricles has it all."""
        chambers = self.report.chambers if self.report else {}
        left = chambers.get(Structure.LV_ENDO)
        return (
            left is not None
            and (left.ed_frame, left.es_frame) == (function.ed_frame, function.es_frame)
            and (function.rv_edv_ml is None or Structure.RV_ENDO in chambers)
        )

    @property
    def not_observed(self) -> str:
        """What of the motion no contour shows."""
        return NOT_OBSERVED


def cycle_page(measured: Measured, frames: Sequence[FramePage]) -> CyclePage | None:
    """Of a subject with three frames or more; None of others."""
    report = measured.report
    if len(frames) < FEWEST_FRAMES:
        return None
    times = frame_times(report.frames, is_whole_cycle=report.options.sequence.whole_cycle)
    moving = moving_surfaces(measured, times)
    return CyclePage(
        id="cycle",
        report=report.cycle,
        times=times,
        moving=moving,
        scene=cycle_scene(moving, times, frames, report.axes) if moving else None,
        charts=cycle_charts(report.cycle, times, NOT_OBSERVED) if report.cycle else [],
    )
