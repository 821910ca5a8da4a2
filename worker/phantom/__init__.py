"""Hearts with known truth, and the slicing of any closed surface into contours."""

from worker.phantom.analytic_heart import Heart, heart
from worker.phantom.shape import HeartShape
from worker.phantom.slicing import SlicedStudy, slice_frames, slice_meshes
from worker.phantom.slicing_plan import SlicingPlan
from worker.phantom.standard_study import standard_study

__all__ = [
    "Heart",
    "HeartShape",
    "SlicedStudy",
    "SlicingPlan",
    "heart",
    "slice_frames",
    "slice_meshes",
    "standard_study",
]
