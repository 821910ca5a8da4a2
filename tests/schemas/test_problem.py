"""Problems as RFC 9457 documents, and their page in the documents."""

import re
from multiprocessing.reduction import ForkingPickler
from pathlib import Path

import pytest

from schemas.problem import Fault, InputError, InternalError, Problem, ProblemPart, ProblemType

PAGE = (Path(__file__).parents[2] / "docs" / "problems.md").read_text()


@pytest.mark.parametrize("kind", [InputError, InternalError])
def test_an_error_is_the_same_in_another_process(kind: type[InputError] | type[InternalError]):
    part = ProblemPart(pointer="/a", detail="b")
    error = kind(ProblemType.NO_SURFACE, "Empty.", pointer="/study", errors=[part])
    again = ForkingPickler.loads(ForkingPickler.dumps(error))
    assert type(again) is kind
    assert str(again) == "Empty."
    assert again.problem() == error.problem()


def test_the_callers_error_is_rendered() -> None:
    error = InputError(
        ProblemType.OFF_PLANE_POINTS,
        "One point is off its plane. Remedy: move it.",
        pointer="/study/frames/0",
        errors=[ProblemPart(pointer="/a", detail="b")],
    )
    assert error.problem("/v1/jobs/1").model_dump(mode="json") == {
        "type": "urn:neuralmri:problem:off-plane-points",
        "title": "Off plane points",
        "status": 422,
        "detail": "One point is off its plane. Remedy: move it.",
        "fault": "caller",
        "instance": "/v1/jobs/1",
        "pointer": "/study/frames/0",
        "errors": [{"pointer": "/a", "detail": "b"}],
        "trace_id": None,
    }


def test_our_own_error_is_told_apart() -> None:
    problem = InternalError(ProblemType.INTERNAL, "Try again.").problem()
    assert (problem.status, problem.fault) == (500, Fault.SERVICE)


def test_a_status_of_its_own_wins() -> None:
    assert InputError(ProblemType.TOO_LARGE, "x", status=413).problem().status == 413


@pytest.mark.parametrize("status", [200, 302, 600])
def test_no_problem_is_a_success(status: int) -> None:
    with pytest.raises(ValueError, match="status"):
        Problem(type="t", title="t", status=status, detail="d", fault=Fault.CALLER)


def test_types_are_unique_and_spelled_for_a_uri() -> None:
    uris = [t.uri for t in ProblemType]
    assert len(set(uris)) == len(uris)
    assert all(re.fullmatch(r"urn:neuralmri:problem:[a-z]+(-[a-z]+)*", uri) for uri in uris)


@pytest.mark.parametrize("type_", list(ProblemType))
def test_every_type_is_documented_with_a_remedy(type_: ProblemType) -> None:
    section = re.search(rf"^### {type_.value}\n(.*?)(?=^##|\Z)", PAGE, re.MULTILINE | re.DOTALL)
    assert section, f"docs/problems.md has no section {type_.value}"
    for said in ("**Status**", "**Who acts**", "**Meaning**", "**Remedy**"):
        assert said in section.group(1)


def test_nothing_else_is_documented() -> None:
    assert set(re.findall(r"^### (\S+)", PAGE, re.MULTILINE)) == {t.value for t in ProblemType}
