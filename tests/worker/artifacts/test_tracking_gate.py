"""Tracked meshes that can stand for a surface, and each fault that they may have."""

from dataclasses import replace

import pytest

from schemas.vocabulary import Structure
from tests.worker.artifacts.beating_spheres import ball, tracked, tracked_frame
from worker.artifacts.tracking_findings import tracking_findings
from worker.artifacts.tracking_gate import LARGEST_MEAN_MM, tracking_faults
from worker.artifacts.tracking_report import tracking_report
from worker.tracking.untangling import LEAST_ANGLE_DEG


def test_a_sound_mesh_is_fit_up_to_the_bounds() -> None:
    bounds = {"mean_mm": LARGEST_MEAN_MM, "least_angle_deg": LEAST_ANGLE_DEG}
    assert tracking_faults(tracked_frame("F0", **bounds)) == []
    # On an end thinner than the triangles the nearest side may be the other one.
    assert tracking_faults(tracked_frame("F0", against_surface=3)) == []


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"turned_over": 1}, "1 triangle turned over"),
        ({"folded": 4}, "4 triangles folded onto a neighbour"),
        ({"self_intersections": 2}, "2 pairs of triangles passing through each other"),
        ({"mean_mm": 0.31}, "0.31 mm from the frame's own surface"),
        ({"least_angle_deg": 7.25}, "least angle is 7.2 degrees, under 10"),
    ],
)
def test_each_fault_is_named_with_its_remedy(changes: dict[str, float], said: str) -> None:
    (reason,) = tracking_faults(tracked_frame("F0", **changes))
    assert said in reason
    assert "target_edge_mm" in reason


def test_the_report_says_so_and_the_worst_frame_is_a_concern() -> None:
    sound = tracked([ball(20.0)] * 3, ["F0", "F1", "F2"])
    frames = (
        tracked_frame("F0"),
        tracked_frame("F1", mean_mm=0.5),
        tracked_frame("F2", folded=2, mean_mm=0.3),
    )
    faulty = replace(sound, frames=frames)
    report = tracking_report({Structure.LV_ENDO: sound, Structure.RV_ENDO: faulty})
    assert all(frame.fit for frame in report[Structure.LV_ENDO].frames.values())
    found = report[Structure.RV_ENDO].frames
    assert [found[label].fit for label in ("F0", "F1", "F2")] == [True, False, False]
    assert [len(found[label].reasons) for label in ("F0", "F1", "F2")] == [0, 1, 2]
    (finding,) = tracking_findings(report)
    assert not finding.grave
    assert finding.text.startswith(
        "rv_endo: its tracked mesh is not fit in 2 of 3 frames. F2: It has 2 triangles folded"
    )
    assert tracking_findings({}) == []
