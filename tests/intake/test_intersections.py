"""Along the line that two slices share, they tell the same story."""

from typing import Any

import pytest

from intake.intersections import check_intersections
from intake.placed import PlacedFrame, place
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy
from tests.studies.ellipsoid import good_request

EXTENT_MM = 150.0


def frame_after(shift_mm: float) -> PlacedFrame:
    """The good study, its long-axis slice shifted along x."""
    study: dict[str, Any] = good_request()["study"]
    for contour in study["frames"][0]["slices"][5]["contours"]:
        for point in contour["points"]:
            point[0] += shift_mm
    return place(ContourStudy.model_validate(study), "/study")[0]


@pytest.mark.parametrize("shift_mm", [0.0, 3.0, -3.0])
def test_breath_hold_shifts_are_no_contradiction(shift_mm: float) -> None:
    assert check_intersections(frame_after(shift_mm), EXTENT_MM) == []


def test_the_share_is_that_of_shifted_intervals() -> None:
    """Intervals of lengths L shifted by d share sum(L - d) of sum(L + d)."""
    lengths = [
        2 * half * (1 - (z / height) ** 2) ** 0.5
        for half, height in ((20, 40), (30, 50), (18, 35))
        for z in (-24, -12, 0, 12, 24)
    ]
    share = sum(v - 12 for v in lengths) / sum(v + 12 for v in lengths)
    (warning,) = check_intersections(frame_after(12.0), EXTENT_MM)
    assert f"only {100 * share:.0f} %; slice lax-00 disagrees most" in warning


def test_slices_of_different_hearts_are_refused() -> None:
    with pytest.raises(InputError) as caught:
        check_intersections(frame_after(200.0), EXTENT_MM)
    assert caught.value.type is ProblemType.CONTRADICTING_SLICES
    assert caught.value.pointer == "/study/frames/0/slices/5"


def test_parallel_slices_share_no_line() -> None:
    frame = frame_after(200.0)
    parallel = PlacedFrame(frame.label, frame.slices[:5], frame.pointer)
    assert check_intersections(parallel, EXTENT_MM) == []
