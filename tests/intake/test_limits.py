"""Counts are held against limits before anything is computed."""

import pytest

from intake.limits import Limits, check_size
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy
from tests.studies.ellipsoid import ELLIPSOIDS, POINTS, good_request

SLICE_COUNT = 6
CONTOURS = SLICE_COUNT * len(ELLIPSOIDS)


@pytest.fixture
def study() -> ContourStudy:
    return ContourStudy.model_validate(good_request()["study"])


@pytest.mark.parametrize(
    ("limit", "found", "pointer"),
    [
        ("max_frames", 1, "/study/frames"),
        ("max_slices", SLICE_COUNT, "/study/frames/0/slices"),
        ("max_contours", CONTOURS, "/study/frames"),
        ("max_points", CONTOURS * POINTS, "/study/frames"),
        ("max_points_per_contour", POINTS, "/study/frames/0/slices/0/contours/0/points"),
    ],
)
def test_a_count_may_reach_its_limit_and_no_more(
    study: ContourStudy, limit: str, found: int, pointer: str
) -> None:
    check_size(study, Limits(**{limit: found}))
    with pytest.raises(InputError) as caught:
        check_size(study, Limits(**{limit: found - 1}))
    error = caught.value
    assert (error.type, error.status, error.pointer) == (ProblemType.TOO_LARGE, 413, pointer)
    assert f"{found} " in error.detail
    assert f"at most {found - 1} " in error.detail
    assert "Remedy" in error.detail
