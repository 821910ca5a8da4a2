"""A batch as its caller sees it: partial success, one parent, and nothing twice."""

import json
from typing import Any

import httpx
import pytest
from redis import Redis

from schemas.job import JobState
from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.service.callers import Serve, bearer, new_key
from tests.service.conftest import Api
from tests.service.jobs_done import claim, finish
from tests.service.test_audit import lines
from tests.service.test_jobs import problem_of
from tests.service.test_submit_labels import GOOD, form

STUDY: dict[str, Any] = CONTOUR_REQUEST["study"]
KEY = {"Idempotency-Key": "the night of the 3rd"}


def named(*names: str, **changes: Any) -> list[dict[str, Any]]:
    return [{"name": name, "study": {**STUDY, **changes}} for name in names]


def post(api: Api, studies: list[Any], headers: dict[str, str] | None = None, **body: Any) -> Any:
    sent = {"studies": studies, "options": CONTOUR_REQUEST["options"], **body}
    return api.client.post("/v1/batches/contours", json=sent, headers=headers)


def accepted(answer: httpx.Response) -> dict[str, Any]:
    assert answer.status_code == 202, answer.text
    batch: dict[str, Any] = answer.json()
    assert answer.headers["location"] == f"/v1/batches/{batch['id']}" == batch["links"]["self"]
    assert int(answer.headers["retry-after"]) > 0
    return batch


def job_ids(batch: dict[str, Any]) -> list[str]:
    return [member["job_id"] for member in batch["studies"] if member["job_id"]]


def now(api: Api, batch: dict[str, Any]) -> dict[str, Any]:
    answer = api.client.get(batch["links"]["self"])
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def nothing_is_left(api: Api) -> bool:
    batches = list((api.settings.data_dir / "batches").iterdir())
    return api.store.ids() == api.records.ids() == batches == []


@pytest.fixture(autouse=True)
def no_batches(api: Api) -> None:
    for path in (api.settings.data_dir / "batches").iterdir():
        path.unlink()


def test_each_study_is_accepted_or_refused_by_itself_in_order(api: Api) -> None:
    bad = {"name": "flat", "study": {**STUDY, "units": "um"}}
    answer = post(api, [*named("a"), bad, *named("b"), "no object", {"study": STUDY, "nam": "c"}])
    batch = accepted(answer)
    states = [(m["name"], m["state"]) for m in batch["studies"]]
    assert states == [
        ("a", "queued"),
        ("flat", "refused"),
        ("b", "queued"),
        (None, "refused"),
        (None, "refused"),
    ]
    errors = [m["error"] for m in batch["studies"] if m["state"] == "refused"]
    assert [e["type"].rpartition(":")[2] for e in errors] == [
        "implausible-size",
        "invalid-request",
        "invalid-request",
    ]
    assert [e["pointer"] for e in errors] == [
        "/studies/1/study/units",
        "/studies/3",
        "/studies/4/nam",
    ]
    assert (batch["counts"]["queued"], batch["counts"]["refused"]) == (2, 3)
    assert (batch["fraction"], batch["ended"], batch["priority"]) == (0.0, False, "batch")
    assert job_ids(batch) == api.store.ids() == api.records.ids()
    for job_id, name in zip(job_ids(batch), "ab", strict=True):
        job = api.client.get(f"/v1/jobs/{job_id}").json()
        assert (job["batch_id"], job["name"]) == (batch["id"], name)
        assert (job["priority"], job["state"]) == ("batch", "queued")
    assert now(api, batch) == batch


def test_options_of_a_study_go_over_those_of_the_batch(api: Api) -> None:
    own = {"study": STUDY, "options": {"seed": 5, "mesh": {"grid_mm": 2.5}}}
    shared = {"preset": "fast", "seed": 4, "mesh": {"projection_steps": 1}}
    batch = accepted(post(api, [own, {"study": STUDY}], options=shared))
    first, second = (api.store.folder(job_id).request().contours for job_id in job_ids(batch))
    assert first
    assert second
    assert (first.options.seed, second.options.seed) == (5, 4)
    assert (first.options.mesh.grid_mm, first.options.mesh.projection_steps) == (2.5, 1)


@pytest.mark.parametrize(
    ("change", "status", "pointer"),
    [
        ({"studies": []}, 422, "/studies"),
        ({"studies": 3}, 422, "/studies"),
        ({"options": {"seeed": 1}}, 422, "/options/seeed"),
        ({"option": {}}, 422, "/option"),
    ],
)
def test_a_body_that_is_no_batch(
    api: Api, change: dict[str, Any], status: int, pointer: str
) -> None:
    answer = post(api, **{"studies": named("a"), **change})
    assert problem_of(answer, status, ProblemType.INVALID_REQUEST).pointer == pointer
    assert nothing_is_left(api)


def test_where_none_is_accepted_nothing_is_kept(api: Api) -> None:
    alike = post(api, named("a", "b", units="um"), KEY)
    problem = problem_of(alike, 422, ProblemType.IMPLAUSIBLE_SIZE)
    assert [part.pointer for part in problem.errors] == [
        "/studies/0/study/units",
        "/studies/1/study/units",
    ]
    several = post(api, [*named("a", units="um"), {}], KEY)
    assert len(problem_of(several, 422, ProblemType.BATCH_REFUSED).errors) == 2
    assert nothing_is_left(api)
    accepted(post(api, named("a"), KEY))  # the key is free


def test_one_study_a_line(api: Api) -> None:
    good = json.dumps({"name": "a", "study": STUDY, "options": {"preset": "fast"}})
    body = f'{good}\r\n\n{{"name": "b", "study"\n{json.dumps({"study": STUDY})}\n'
    answer = api.client.post(
        "/v1/batches/contours", content=body, headers={"Content-Type": "application/x-ndjson"}
    )
    batch = accepted(answer)
    assert [m["state"] for m in batch["studies"]] == ["queued", "refused", "queued"]
    error = batch["studies"][1]["error"]
    assert (error["type"], error["pointer"]) == (
        "urn:neuralmri:problem:malformed-json",
        "/studies/1",
    )
    nothing = api.client.post(
        "/v1/batches/contours", content=" \n", headers={"Content-Type": "application/x-ndjson"}
    )
    problem_of(nothing, 422, ProblemType.INVALID_REQUEST)


def test_what_does_not_fit_is_refused_with_a_time(
    serve: Serve, settings: ServiceSettings, redis: Redis
) -> None:
    api = serve(settings.model_copy(update={"max_queued_jobs": 2}))
    batch = accepted(post(api, named("a", "b", "c", "d")))
    assert [m["state"] for m in batch["studies"]] == ["queued", "queued", "refused", "refused"]
    for place in (2, 3):
        member = batch["studies"][place]
        assert member["error"]["type"] == ProblemType.QUEUE_FULL.uri
        assert member["error"]["pointer"] == f"/studies/{place}"
        assert member["retry_after_s"] >= 1
    none = post(api, named("e", "f"))
    problem_of(none, 503, ProblemType.QUEUE_FULL)
    assert int(none.headers["retry-after"]) >= 1
    assert api.store.ids() == api.records.ids() == job_ids(batch)
    assert len(api.client.get("/v1/batches").json()["batches"]) == 1


def test_a_callers_own_bound_counts(serve: Serve, settings: ServiceSettings, redis: Redis) -> None:
    api = serve(settings.model_copy(update={"max_jobs_per_owner": 1}))
    batch = accepted(post(api, named("a", "b")))
    assert batch["studies"][1]["error"]["type"] == ProblemType.TOO_MANY_JOBS.uri
    answer = post(api, named("c"))
    problem_of(answer, 429, ProblemType.TOO_MANY_JOBS)
    assert int(answer.headers["retry-after"]) >= 1


def test_a_batch_has_so_many_studies_and_no_more(
    serve: Serve, settings: ServiceSettings, redis: Redis
) -> None:
    api = serve(settings.model_copy(update={"max_batch_studies": 2}))
    assert problem_of(post(api, named(*"abc")), 413, ProblemType.TOO_LARGE).pointer == "/studies"
    batch = accepted(post(api, named(*"ab")))
    joining = api.client.post(f"/v1/jobs/contours?batch={batch['id']}", json=CONTOUR_REQUEST)
    assert problem_of(joining, 413, ProblemType.TOO_LARGE).pointer == "/query/batch"
    assert api.store.ids() == job_ids(batch)


def test_submissions_of_any_kind_join(api: Api) -> None:
    batch = accepted(api.client.post("/v1/batches"))
    assert (batch["studies"], batch["ended"], batch["fraction"]) == ([], True, 0.0)
    place = f"batch={batch['id']}"
    maps = form(GOOD.files(), dict(GOOD.request))
    labels = api.client.post(f"/v1/jobs/labels?{place}&name=maps", files=maps).json()
    study = api.client.post(f"/v1/jobs/contours?{place}", json=CONTOUR_REQUEST).json()
    api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST)
    api.client.post(f"/v1/jobs/{study['id']}/cancel")
    again = api.client.post(f"/v1/jobs/{study['id']}/restart?{place}&name=again").json()
    alone = api.client.post(f"/v1/jobs/{study['id']}/restart").json()
    assert (labels["batch_id"], labels["name"], labels["priority"]) == (
        batch["id"],
        "maps",
        "batch",
    )
    assert (alone["batch_id"], alone["priority"]) == (None, "interactive")
    found = now(api, batch)
    assert [(m["job_id"], m["name"], m["state"]) for m in found["studies"]] == [
        (labels["id"], "maps", "queued"),
        (study["id"], None, "cancelled"),
        (again["id"], "again", "queued"),
    ]
    assert found["fraction"] == pytest.approx(1 / 3)
    listed = api.client.get(f"/v1/jobs?{place}").json()["jobs"]
    assert [job["id"] for job in listed] == [again["id"], study["id"], labels["id"]]
    queued = api.client.get(f"/v1/jobs?{place}&state=queued").json()["jobs"]
    assert [job["id"] for job in queued] == [again["id"], labels["id"]]
    api.redis.flushall()
    assert now(api, batch)["studies"] == found["studies"], "rebuilt from the folders"
    problem_of(
        api.client.post("/v1/jobs/contours?name=x", json=CONTOUR_REQUEST),
        422,
        ProblemType.INVALID_REQUEST,
    )


def test_pages_of_studies(api: Api) -> None:
    batch = accepted(post(api, named(*"abc")))
    joined = api.client.post(f"/v1/jobs/contours?batch={batch['id']}", json=CONTOUR_REQUEST).json()
    seen: list[str] = []
    query: dict[str, Any] = {"limit": 2}
    while True:
        page = api.client.get(batch["links"]["self"], params=query).json()
        seen += job_ids(page)
        assert page["counts"]["queued"] == 4
        if page["next_cursor"] is None:
            break
        query["cursor"] = page["next_cursor"]
    assert seen == [*job_ids(batch), joined["id"]]


def test_batches_are_listed_newest_first(api: Api) -> None:
    ids = [accepted(post(api, named("a")))["id"] for _ in range(3)]
    first = api.client.get("/v1/batches?limit=2").json()
    second = api.client.get(f"/v1/batches?limit=2&cursor={first['next_cursor']}").json()
    pages = [first["batches"], second["batches"]]
    assert [[batch["id"] for batch in page] for page in pages] == [[ids[2], ids[1]], [ids[0]]]
    assert second["next_cursor"] is None
    assert first["batches"][0]["counts"]["queued"] == 1


def test_how_it_ends_is_said_for_each(api: Api) -> None:
    batch = accepted(post(api, named(*"abcd")))
    a, b, c, d = job_ids(batch)
    finish(api.store, api.records, a, JobState.SUCCEEDED)
    finish(api.store, api.records, b, JobState.FAILED)
    claim(api.records, c)
    api.client.delete(f"/v1/jobs/{d}")
    found = now(api, batch)
    states = [m["state"] for m in found["studies"]]
    assert states == ["succeeded", "failed", "running", "erased"]
    assert (found["ended"], found["fraction"]) == (False, pytest.approx(2 / 3))
    assert found["studies"][3]["links"] is None


def test_cancelling_is_honest_and_idempotent(api: Api) -> None:
    batch = accepted(post(api, named(*"abc")))
    a, b, _ = job_ids(batch)
    finish(api.store, api.records, a, JobState.SUCCEEDED)
    claim(api.records, b)
    answer = api.client.post(batch["links"]["cancel"])
    assert answer.status_code == 202, answer.text
    assert int(answer.headers["retry-after"]) >= 1
    states = [m["state"] for m in answer.json()["studies"]]
    assert states == ["succeeded", "cancelling", "cancelled"]
    assert api.client.post(batch["links"]["cancel"]).json() == answer.json()
    api.client.delete(f"/v1/jobs/{b}")
    again = api.client.post(batch["links"]["cancel"])
    assert (again.status_code, again.json()["ended"]) == (200, True)


def test_erasing_takes_every_job_along(api: Api) -> None:
    batch = accepted(post(api, named(*"ab"), KEY))
    api.client.post(f"/v1/jobs/contours?batch={batch['id']}", json=CONTOUR_REQUEST)
    other = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST).json()["id"]
    claim(api.records, job_ids(batch)[0])
    for _ in range(2):
        assert api.client.delete(batch["links"]["self"]).status_code == 204
    assert api.store.ids() == api.records.ids() == [other]
    problem_of(api.client.get(batch["links"]["self"]), 404, ProblemType.NOT_FOUND)
    problem_of(api.client.get(batch["links"]["jobs"]), 404, ProblemType.NOT_FOUND)
    late = api.client.post(f"/v1/jobs/contours?batch={batch['id']}", json=CONTOUR_REQUEST)
    problem_of(late, 404, ProblemType.NOT_FOUND)
    assert [key for key in api.redis.scan_iter() if batch["id"] in key] == [
        f"neuralmri:erased:{batch['id']}"
    ]
    assert accepted(post(api, named(*"ab"), KEY))["id"] != batch["id"], "the key is free"


def test_anothers_batch_is_not_there(keyed: Api) -> None:
    data_dir = keyed.settings.data_dir
    mine, theirs = (bearer(new_key(data_dir, owner)[1]) for owner in ("ours", "theirs"))
    batch = accepted(post(keyed, named("a", "b"), mine))
    (first, _) = job_ids(batch)
    finish(keyed.store, keyed.records, first, JobState.SUCCEEDED)
    here = batch["links"]["self"]
    for who in (theirs, {**theirs, **KEY}):
        for method, path in (
            ("GET", here),
            ("POST", f"{here}/cancel"),
            ("DELETE", here),
            ("GET", f"{here}/artifacts.zip"),
            ("GET", f"/v1/jobs/{first}/artifacts.zip"),
            ("GET", batch["links"]["jobs"]),
        ):
            answer = keyed.client.request(method, path, headers=who)
            problem_of(answer, 404, ProblemType.NOT_FOUND)
        joining = keyed.client.post(
            f"/v1/jobs/contours?batch={batch['id']}", json=CONTOUR_REQUEST, headers=who
        )
        problem_of(joining, 404, ProblemType.NOT_FOUND)
    assert keyed.client.get("/v1/batches", headers=theirs).json()["batches"] == []
    assert len(keyed.client.get("/v1/batches", headers=mine).json()["batches"]) == 1
    assert keyed.store.ids() == job_ids(batch)
    for _ in range(2):
        assert keyed.client.delete(here, headers=mine).status_code == 204
        problem_of(keyed.client.delete(here, headers=theirs), 404, ProblemType.NOT_FOUND)


def test_keys_of_two_owners_are_apart(keyed: Api) -> None:
    data_dir = keyed.settings.data_dir
    mine, theirs = (bearer(new_key(data_dir, owner)[1]) for owner in ("ours", "theirs"))
    ids = {accepted(post(keyed, named("a"), who | KEY))["id"] for who in (mine, theirs, mine)}
    assert len(ids) == 2


def test_the_audit_log_names_batch_and_jobs(keyed: Api) -> None:
    mine = bearer(new_key(keyed.settings.data_dir, "ours")[1])
    batch = accepted(post(keyed, named("a", "b"), mine))
    keyed.client.get(batch["links"]["self"], headers=mine)
    keyed.client.post(batch["links"]["cancel"], headers=mine)
    keyed.client.delete(batch["links"]["self"], headers=mine)
    about = [batch["id"], *job_ids(batch)]
    assert [(entry["action"], entry["job"]) for entry in lines(keyed, "done")] == [
        (action, id_) for action in ("submit", "cancel", "erase") for id_ in about
    ]


@pytest.mark.parametrize("batch_id", ["bt_" + "0" * 32, "0" * 32, "nonsense"])
def test_unknown_batches(api: Api, batch_id: str) -> None:
    for method, path in (("GET", ""), ("POST", "/cancel"), ("GET", "/artifacts.zip")):
        answer = api.client.request(method, f"/v1/batches/{batch_id}{path}")
        assert answer.status_code == 404, answer.text


def test_an_unreadable_record_hides_one_batch_only(api: Api) -> None:
    batch = accepted(post(api, named("a")))
    bad = api.settings.data_dir / "batches" / f"bt_{'f' * 32}.json"
    bad.write_text("{")
    assert [b["id"] for b in api.client.get("/v1/batches").json()["batches"]] == [batch["id"]]
    assert api.client.get(f"/v1/batches/{bad.stem}").status_code == 404
