"""The phantom as it would be scanned: the study that tests, demo and examples share."""

from collections.abc import Mapping
from types import MappingProxyType

from schemas.study import ContourStudy
from worker.phantom.analytic_heart import heart
from worker.phantom.shape import HeartShape
from worker.phantom.slicing import slice_frames
from worker.phantom.slicing_plan import STANDARD_PLAN, SlicingPlan

DIASTOLE: Mapping[str, float] = MappingProxyType({"ED": 0.0})
"""One frame: end-diastole."""

ONE_BEAT: Mapping[str, float] = MappingProxyType({"ED": 0.0, "ES": 1.0})
"""End-diastole and end-systole."""


def standard_study(
    phases: Mapping[str, float] = DIASTOLE,
    *,
    shape: HeartShape | None = None,
    plan: SlicingPlan = STANDARD_PLAN,
    edge_mm: float = 1.0,
    subject_id: str = "phantom",
) -> ContourStudy:
    """The phantom heart sliced at each of `phases` (frame label -> phase)."""
    frames = {label: heart(phase, shape).meshes(edge_mm) for label, phase in phases.items()}
    return slice_frames(frames, plan, subject_id=subject_id).study
