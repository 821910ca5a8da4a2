"""Area strain of a tracked surface over the cycle, as a whole and by segment of the wall."""

from collections.abc import Sequence
from dataclasses import dataclass

from schemas.cycle_report import Series
from worker.arrays import SomeScalars
from worker.evaluation.aha_segments import NAMES, LeftVentricle, aha_segments
from worker.evaluation.area_share import vertex_areas_mm2
from worker.evaluation.area_spread import AreaSpread, area_spread
from worker.surface_mesh import SurfaceMesh
from worker.tracking.area_strain import area_strain
from worker.tracking.tracked_surface import TrackedSurface


@dataclass(frozen=True, eq=False)
class CycleStrain:
    """at_ed: the tracked mesh at end-diastole. percent: by frame of the cycle, at each of its
    vertices (n,); None where the surface was not tracked.
    """

    at_ed: SurfaceMesh
    percent: Sequence[SomeScalars | None]

    def spread(self) -> list[AreaSpread | None]:
        """By frame, weighed by the area at end-diastole: so the mean is the surface's own."""
        areas_mm2 = vertex_areas_mm2(self.at_ed)
        return [None if one is None else area_spread(areas_mm2, one) for one in self.percent]

    def by_segment(self, ventricle: LeftVentricle) -> dict[int, Series]:
        """Mean by frame in each segment that has a vertex at end-diastole, weighed likewise."""
        areas_mm2 = vertex_areas_mm2(self.at_ed)
        segment_of = aha_segments(self.at_ed.vertices_mm, ventricle)
        parts = {number: areas_mm2 * (segment_of == number) for number in NAMES}
        return {
            number: [
                None if one is None else float(part @ one / part.sum()) for one in self.percent
            ]
            for number, part in parts.items()
            if part.any()
        }


def cycle_strain(
    tracked: TrackedSurface, labels: Sequence[str], ed_frame: str
) -> CycleStrain | None:
    """To `ed_frame`, by frame of `labels`; None where the surface was not tracked to `ed_frame`."""
    index = {frame.label: i for i, frame in enumerate(tracked.frames)}
    if ed_frame not in index:
        return None
    percent = 100.0 * area_strain(tracked, index[ed_frame])
    return CycleStrain(
        at_ed=tracked.mesh(index[ed_frame]),
        percent=[percent[index[label]] if label in index else None for label in labels],
    )
