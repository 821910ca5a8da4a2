"""What the schema of a contour study accepts and what it refuses."""

from typing import Any

import pytest
from pydantic import ValidationError

from schemas.study import Contour, ContourStudy, Frame, Slice
from tests.studies.ellipsoid import good_request

TRIANGLE = {"structure": "lv_endo", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}
PLANE = {"origin": [0, 0, 0], "normal": [0, 0, 1]}


def test_a_study_survives_the_wire() -> None:
    study = ContourStudy.model_validate(good_request()["study"])
    assert ContourStudy.model_validate_json(study.model_dump_json()) == study


@pytest.mark.parametrize(
    "slice_",
    [
        {"contours": [TRIANGLE]},
        {"contours": [TRIANGLE], **PLANE},
        {"absent": ["rv_endo"], **PLANE},
        {"contours": [TRIANGLE, TRIANGLE], "absent": ["rv_endo", "epi"], **PLANE},
        {"contours": [TRIANGLE], "origin": [0, 0, 0], "normal": [0, 0, -1e-300]},
    ],
)
def test_slices_that_say_something_are_accepted(slice_: dict[str, Any]) -> None:
    assert Slice.model_validate({"id": "sax-00", **slice_}).id == "sax-00"


@pytest.mark.parametrize(
    ("slice_", "said"),
    [
        ({}, "says nothing"),
        (PLANE, "says nothing"),
        ({"absent": ["rv_endo"]}, "needs `origin` and `normal`"),
        ({"contours": [TRIANGLE], "origin": [0, 0, 0]}, "give both"),
        ({"contours": [TRIANGLE], "normal": [0, 0, 1]}, "give both"),
        ({"contours": [TRIANGLE], "origin": [0, 0, 0], "normal": [0, 0, 0]}, "zero vector"),
        ({"contours": [TRIANGLE], "absent": ["lv_endo"]}, "lv_endo has contours here"),
        ({"contours": [TRIANGLE], "absent": ["rv_endo"] * 6}, "at most 5"),
        ({"contours": [TRIANGLE], "thickness_mm": 8}, "Extra inputs"),
    ],
)
def test_slices_that_contradict_themselves_are_refused(slice_: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        Slice.model_validate({"id": "sax-00", **slice_})


@pytest.mark.parametrize("name", ["a", "sax-00", "Case_01.b", "a" * 64])
def test_names_that_can_be_files(name: str) -> None:
    assert Slice.model_validate({"id": name, "contours": [TRIANGLE]}).id == name


@pytest.mark.parametrize("name", ["", "a b", "a/b", "..\\x", "é", "a\n", "a\x00", "a" * 65])
def test_names_that_cannot(name: str) -> None:
    with pytest.raises(ValidationError):
        Slice.model_validate({"id": name, "contours": [TRIANGLE]})


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1.1e7, -1.1e7, None, "x"])
def test_coordinates_are_finite_and_bounded(value: Any) -> None:
    with pytest.raises(ValidationError):
        Contour.model_validate({**TRIANGLE, "points": [[0, 0, 0], [1, 0, 0], [0, value, 0]]})


@pytest.mark.parametrize("second", ["sax-00", "SAX-00", "Sax-00"])
def test_slice_ids_are_unique_whatever_their_case(second: str) -> None:
    slices = [{"id": name, "contours": [TRIANGLE]} for name in ("sax-00", second)]
    with pytest.raises(ValidationError, match="slice id used more than once: sax-00"):
        Frame.model_validate({"label": "ED", "slices": slices})


def test_frames_may_repeat_each_others_slice_ids() -> None:
    study = good_request()["study"]
    study["frames"].append({**study["frames"][0], "label": "ES"})
    assert len(ContourStudy.model_validate(study).frames) == 2


def test_a_list_is_judged_up_to_its_first_fault() -> None:
    bad = {**TRIANGLE, "points": [["x", "y", "z"]] * 1000}
    with pytest.raises(ValidationError) as caught:
        Contour.model_validate(bad)
    assert caught.value.error_count() <= 3
