"""Every bad study gets its one answer, and the good one that all are made from gets none."""

import json
import re

import pytest

from intake.contour_request import read_contour_request
from schemas.problem import Fault, InputError, ProblemType
from tests.studies.catalogue import BAD_STUDIES, BadStudy
from tests.studies.ellipsoid import good_request


def test_the_good_study_is_admitted_without_a_warning() -> None:
    request, warnings = read_contour_request(json.dumps(good_request()).encode())
    assert warnings == []
    assert request.study.subject_id == "ellipsoid"


@pytest.mark.parametrize("bad", BAD_STUDIES, ids=lambda bad: bad.name)
def test_a_bad_study_is_refused(bad: BadStudy) -> None:
    with pytest.raises(InputError) as caught:
        read_contour_request(bad.raw)
    error = caught.value
    assert (error.type, error.status, error.pointer) == (bad.type, bad.status, bad.pointer), str(
        error
    )
    problem = error.problem()
    assert problem.fault is Fault.CALLER
    # The answer must survive the wire, name no place in our code, and not echo the body.
    assert problem.model_dump_json().encode("utf-8")
    assert len(error.detail) < 600
    assert not re.search(r"Traceback|\.py|pydantic", error.detail)


@pytest.mark.parametrize("bad", BAD_STUDIES, ids=lambda bad: bad.name)
def test_a_pointer_leads_into_the_request(bad: BadStudy) -> None:
    """Every pointer resolves, or its parent does when it names a member that is missing."""
    if bad.pointer is None:
        return
    place = json.loads(bad.raw)
    steps = [s.replace("~1", "/").replace("~0", "~") for s in bad.pointer.split("/")[1:]]
    for k, step in enumerate(steps):
        try:
            place = place[int(step)] if isinstance(place, list) else place[step]
        except (KeyError, IndexError):
            assert k == len(steps) - 1


def test_names_are_unique() -> None:
    names = [bad.name for bad in BAD_STUDIES]
    assert len(set(names)) == len(names)


def test_every_problem_of_contour_studies_is_in_the_catalogue() -> None:
    covered = {bad.type for bad in BAD_STUDIES}
    assert covered >= {
        ProblemType.MALFORMED_JSON,
        ProblemType.INVALID_REQUEST,
        ProblemType.TOO_LARGE,
        ProblemType.OFF_PLANE_POINTS,
        ProblemType.DEGENERATE_CONTOUR,
        ProblemType.SELF_CROSSING_CONTOUR,
        ProblemType.UNCLOSED_CONTOUR,
        ProblemType.IMPLAUSIBLE_SIZE,
        ProblemType.TOO_FEW_SLICES,
        ProblemType.UNSUPPORTED_SURFACE,
        ProblemType.CROSSING_STRUCTURES,
        ProblemType.CONTRADICTING_SLICES,
    }
