import pytest

from schemas.job import Priority
from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from tests.service.conftest import Api
from tests.service.test_jobs import problem_of
from tests.service.test_submit_labels import GOOD, form


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("", Priority.INTERACTIVE),
        ("?priority=interactive", Priority.INTERACTIVE),
        ("?priority=batch", Priority.BATCH),
    ],
)
def test_a_job_says_and_stores_its_priority(api: Api, query: str, expected: Priority) -> None:
    labels = form(GOOD.files(), dict(GOOD.request))
    for answer in (
        api.client.post(f"/v1/jobs/contours{query}", json=CONTOUR_REQUEST),
        api.client.post(f"/v1/jobs/labels{query}", files=labels),
    ):
        assert answer.status_code == 202, answer.text
        assert answer.json()["priority"] == expected
        assert api.store.folder(answer.json()["id"]).request().priority is expected


def test_an_unknown_priority_is_refused(api: Api) -> None:
    answer = api.client.post("/v1/jobs/contours?priority=urgent", json=CONTOUR_REQUEST)
    assert problem_of(answer, 422, ProblemType.INVALID_REQUEST).pointer == "/query/priority"
    assert list(api.store.root.iterdir()) == []
