"""Strict JSON: where a fault is, said so that an engineer can act."""

import json

import pytest

from intake.json_body import MAX_PARTS, parse_json
from intake.limits import Limits
from schemas.labels import LabelRequest, LabelScheme, TissueLabels
from schemas.messages import ContourRequest
from schemas.options import Options
from schemas.problem import InputError, ProblemType
from tests.studies.ellipsoid import good_request

LIMITS = Limits()


def refusal(raw: bytes, model: type = ContourRequest) -> InputError:
    with pytest.raises(InputError) as caught:
        parse_json(raw, model, LIMITS)
    return caught.value


def test_a_good_request_is_read() -> None:
    raw = json.dumps(good_request()).encode()
    assert parse_json(raw, ContourRequest, LIMITS) == ContourRequest.model_validate_json(raw)


def test_syntax_is_placed_by_line_and_column() -> None:
    assert "line 3 column 8" in refusal(b'{\n"study":\n  {"a":,}}').detail


@pytest.mark.parametrize("literal", ["NaN", "Infinity", "-Infinity"])
def test_a_constant_that_is_not_json_is_placed(literal: str) -> None:
    error = refusal(b'{"Infinity NaN": "\\"NaN",\n  "seed": %s}' % literal.encode(), Options)
    assert f"{literal} is not JSON at line 2 column 11" in error.detail


def test_a_key_given_twice_is_named() -> None:
    assert "the key seed stands twice" in refusal(b'{"seed": 1, "seed": 2}', Options).detail


def test_brackets_inside_strings_are_text() -> None:
    raw = json.dumps({"subject_id": '["\\' * 100}).encode()
    assert refusal(raw, LabelRequest).type is ProblemType.INVALID_REQUEST


@pytest.mark.parametrize("depth", [32, 33])
def test_depth_is_capped(depth: int) -> None:
    error = refusal(b"[" * depth + b"]" * depth)
    expected = ProblemType.INVALID_REQUEST if depth == 32 else ProblemType.TOO_LARGE
    assert error.type is expected


def test_bytes_are_capped() -> None:
    limits = Limits(max_request_bytes=10)
    with pytest.raises(InputError, match="11 bytes; at most 10"):
        parse_json(b'{"seed":12}', Options, limits)
    assert parse_json(b'{"seed":1}', Options, limits).seed == 1


def test_every_fault_is_listed_and_the_first_leads() -> None:
    error = refusal(b'{"levels": 0, "seed": -1, "colour": 1}', Options)
    assert [part.pointer for part in error.errors] == ["/levels", "/seed", "/colour"]
    assert error.pointer == "/levels"
    assert "and 2 more" in error.detail


def test_the_list_of_faults_is_capped() -> None:
    raw = json.dumps({f"k{i}": 0 for i in range(100)}).encode()
    assert len(refusal(raw, Options).errors) == MAX_PARTS


def test_a_million_bad_coordinates_are_one_fault_a_list() -> None:
    request = good_request()
    points = request["study"]["frames"][0]["slices"][0]["contours"][0]["points"]
    points[:] = [["1", "2", "3"]] * 100_000
    assert len(refusal(json.dumps(request).encode()).errors) <= 3


def test_types_are_not_converted() -> None:
    for raw in (b'{"seed": "1"}', b'{"seed": 1.0}', b'{"seed": true}', b'{"align_slices": 1}'):
        assert refusal(raw, Options).type is ProblemType.INVALID_REQUEST


def test_integers_are_numbers() -> None:
    assert parse_json(b'{"loss": {"hinge_weight": 1}}', Options, LIMITS).loss.hinge_weight == 1.0


@pytest.mark.parametrize(
    ("scheme", "pointer"),
    [
        ('"ACDC"', "/label_scheme"),
        ("3", "/label_scheme"),
        ('{"lv_wall": [0]}', "/label_scheme"),
        ('{"lv_wall": ["1"]}', "/label_scheme/lv_wall/0"),
        ('{"lv_wall": [1], "aorta": [2]}', "/label_scheme/aorta"),
    ],
)
def test_a_union_is_pointed_into_without_its_branches(scheme: str, pointer: str) -> None:
    raw = f'{{"subject_id": "a", "label_scheme": {scheme}}}'.encode()
    assert refusal(raw, LabelRequest).pointer == pointer


def test_both_branches_of_a_union_are_read() -> None:
    named = parse_json(b'{"subject_id": "a", "label_scheme": "acdc"}', LabelRequest, LIMITS)
    assert named.label_scheme is LabelScheme.ACDC
    raw = b'{"subject_id": "a", "label_scheme": {"lv_wall": [7]}}'
    spelled = parse_json(raw, LabelRequest, LIMITS).label_scheme
    assert isinstance(spelled, TissueLabels)
    assert spelled.lv_wall == [7]


def test_the_body_is_not_echoed() -> None:
    error = refusal(b'{"subject_id": "Jane Doe 1970-01-01", "label_scheme": "acdc"}', LabelRequest)
    assert "Jane" not in error.problem().model_dump_json()


def test_an_endless_key_is_cut_short() -> None:
    error = refusal(json.dumps({"k" * 10_000: 0}).encode(), Options)
    assert error.pointer == "/" + "k" * 64
