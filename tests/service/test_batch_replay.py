"""One key makes one batch with the same jobs, also where a process dies in the middle of it."""

import json
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest
from redis import Redis
from redis.exceptions import RedisError

from jobs.batch_store import BatchStore, batch_tail
from schemas.batch import BatchRecord
from schemas.job import JobState
from schemas.problem import ProblemType
from service.access import JobAccess
from service.batches import taking_in
from service.batches.unfinished import UnfinishedBatches
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.service.callers import Serve
from tests.service.conftest import Api
from tests.service.jobs_done import finish
from tests.service.test_batches import KEY, STUDY, accepted, job_ids, named, no_batches, now, post
from tests.service.test_events import wait_until
from tests.service.test_jobs import problem_of

__all__ = ["no_batches"]

NAMES = ("a", "b", "c")
LOCK = f"neuralmri:batch-lock:{batch_tail('anonymous', KEY['Idempotency-Key'])}"

# Takes the same batch in as the route does, and kills itself at a step of it.
DIES = """
import json, os, signal, sys
from schemas.job import Priority
from schemas.messages import Idempotency
from service.access import JobAccess
from service.batches import reading, submission, taking_in
from service.batches.book import BatchBook
from service.batches.terms import BatchTerms
from service.payload_hash import batch_sha256
from service.settings import ServiceSettings
import jobs.submission

where, at, body = sys.argv[1], int(sys.argv[2]), sys.argv[3].encode()
settings = ServiceSettings()
access = JobAccess.of_settings(settings)
reached = 0

def dying(step):
    def take(*given, **named):
        global reached
        reached += 1
        if reached > at:
            os.kill(os.getpid(), signal.SIGKILL)
        return step(*given, **named)
    return take

if where == "accepting":
    taking_in.submitted = dying(taking_in.submitted)
elif where == "between folder and record":
    access.records.accepted = dying(access.records.accepted)
elif where == "writing":
    BatchBook.write = dying(BatchBook.write)
studies = reading.read_batch(body, reading.JSON, settings.limits(), 100)
limits = settings.limits()
digest = batch_sha256(Priority.BATCH, body, {}, in_lines=False)
key = Idempotency(key=sys.argv[4], payload_sha256=digest)
judge = lambda: studies.judged(limits)
submission.accept_batch(access, judge, "anonymous", BatchTerms(), key)
"""


def body_of(*names: str) -> dict[str, Any]:
    return {"studies": named(*names), "options": CONTOUR_REQUEST["options"]}


def die(api: Api, where: str, at: int) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", DIES, where, str(at), json.dumps(body_of(*NAMES)), *KEY.values()],
        env={
            "NEURALMRI_REDIS_URL": api.settings.redis_url,
            "NEURALMRI_DATA_DIR": str(api.settings.data_dir),
        },
        capture_output=True,
        text=True,
    )
    assert ended.returncode == -9, ended.stderr


def access_of(api: Api) -> JobAccess:
    return JobAccess.of_settings(api.settings)


def replayed(api: Api, answer: Any) -> dict[str, Any]:
    assert answer.headers.get("idempotency-replayed") == "true", answer.text
    return accepted(answer)


def test_the_same_request_is_the_same_batch(api: Api) -> None:
    studies = [*named("a"), {}, *named("b")]
    answer = post(api, studies, KEY)
    batch = accepted(answer)
    assert "idempotency-replayed" not in answer.headers
    finish(api.store, api.records, job_ids(batch)[0], JobState.SUCCEEDED)
    api.client.delete(f"/v1/jobs/{job_ids(batch)[1]}")
    for wiped in (False, True):
        if wiped:
            api.redis.flushall()
        again = replayed(api, post(api, studies, KEY))
        assert again["id"] == batch["id"]
        assert job_ids(again) == job_ids(batch)
        states = [m["state"] for m in again["studies"]]
        assert states == ["succeeded", "refused", "erased"], "an erased one is not made again"
        assert again["studies"][1]["error"] == batch["studies"][1]["error"]
    assert len(api.store.ids()) == 1


def test_another_request_under_the_key_is_refused(api: Api) -> None:
    batch = accepted(post(api, named("a"), KEY))
    for answer in (
        post(api, named("b"), KEY),
        post(api, named("a", "a"), KEY),
        api.client.post(
            "/v1/batches/contours?priority=interactive", json=body_of("a"), headers=KEY
        ),
        api.client.post("/v1/batches", headers=KEY),
    ):
        problem_of(answer, 422, ProblemType.IDEMPOTENCY_KEY_REUSED)
    assert api.store.ids() == job_ids(batch)
    single = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST, headers=KEY)
    assert single.status_code == 202, "keys of jobs are apart"


def test_a_batch_that_was_opened_empty_is_found_again(api: Api) -> None:
    first = accepted(api.client.post("/v1/batches", headers=KEY))
    assert replayed(api, api.client.post("/v1/batches", headers=KEY))["id"] == first["id"]
    assert accepted(api.client.post("/v1/batches"))["id"] != first["id"]


def test_joining_another_batch_is_another_request(api: Api) -> None:
    one, other = (accepted(api.client.post("/v1/batches"))["id"] for _ in range(2))

    def join(query: str) -> httpx.Response:
        return api.client.post(f"/v1/jobs/contours?{query}", json=CONTOUR_REQUEST, headers=KEY)

    first = join(f"batch={one}&name=a")
    assert join(f"batch={one}&name=a").json()["id"] == first.json()["id"]
    for query in (f"batch={other}&name=a", f"batch={one}&name=b", f"batch={one}", "priority=batch"):
        problem_of(join(query), 422, ProblemType.IDEMPOTENCY_KEY_REUSED)


@pytest.mark.integration
def test_many_at_once_with_one_key_are_one_batch(api: Api) -> None:
    start = threading.Barrier(8)

    def send(_: int) -> httpx.Response:
        with httpx.Client(base_url=str(api.client.base_url), timeout=60.0) as client:
            start.wait()
            while True:
                answer = client.post("/v1/batches/contours", json=body_of(*NAMES), headers=KEY)
                if answer.status_code != 409:
                    return answer

    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(send, range(8)))
    assert len({json.dumps(job_ids(accepted(answer))) for answer in answers}) == 1
    assert sorted("idempotency-replayed" in a.headers for a in answers) == [False] + [True] * 7
    assert api.store.ids() == api.records.ids() == sorted(job_ids(answers[0].json()))


CRASHES = [
    ("accepting", 0, 0),
    ("accepting", 2, 2),
    ("between folder and record", 1, 2),
    ("writing", 1, 3),
]
"""Where it dies, at which step, and how many jobs have a folder then."""


@pytest.mark.integration
@pytest.mark.parametrize("by", ["replay", "reconciler", "both, Redis wiped"])
@pytest.mark.parametrize(("where", "at", "folders"), CRASHES)
def test_a_batch_that_was_left_half_taken_in(
    api: Api, where: str, at: int, folders: int, by: str
) -> None:
    die(api, where, at)
    assert len(api.store.ids()) == folders
    (listed,) = api.client.get("/v1/batches").json()["batches"]
    assert (listed["counts"]["pending"], listed["ended"]) == (3 - folders, False)
    planned = job_ids(now(api, listed))
    assert 0 < api.redis.pttl(LOCK) <= 30_000, "it runs out by itself"
    problem_of(post(api, named(*NAMES), KEY), 409, ProblemType.IDEMPOTENCY_KEY_PENDING)
    UnfinishedBatches(access_of(api)).take_in()
    assert len(api.store.ids()) == folders, "another may still be at it"
    api.redis.delete(LOCK)
    if "wiped" in by:
        api.redis.flushall()
    if by != "replay":
        unfinished = UnfinishedBatches(access_of(api))
        for _ in range(2):
            unfinished.take_in()
    if by != "reconciler":
        assert job_ids(replayed(api, post(api, named(*NAMES), KEY))) == planned
    assert api.store.ids() == planned
    batch = now(api, listed)
    assert [m["state"] for m in batch["studies"]] == ["queued"] * 3
    assert (batch["counts"]["queued"], job_ids(batch)) == (3, planned)
    content = BatchStore(api.settings.data_dir / "batches").read(batch["id"])
    assert content is not None
    assert b"points" not in content, "studies are kept once"


@pytest.mark.integration
def test_a_job_that_was_erased_in_between_stays_erased(api: Api) -> None:
    die(api, "accepting", 2)
    api.redis.delete(LOCK)
    first = api.store.ids()[0]
    assert api.client.delete(f"/v1/jobs/{first}").status_code == 204
    UnfinishedBatches(access_of(api)).take_in()
    batch = replayed(api, post(api, named(*NAMES), KEY))
    assert [m["state"] for m in batch["studies"]] == ["erased", "queued", "queued"]
    assert first not in api.store.ids()


@pytest.mark.integration
@pytest.mark.parametrize("what", ["cancel", "erase"])
def test_what_was_left_half_taken_in_can_be_ended(api: Api, what: str) -> None:
    die(api, "accepting", 1)
    api.redis.delete(LOCK)
    (here,) = (b["links"]["self"] for b in api.client.get("/v1/batches").json()["batches"])
    if what == "cancel":
        batch = api.client.post(f"{here}/cancel").json()
        assert [m["state"] for m in batch["studies"]] == ["cancelled"] * 3
        return
    assert api.client.delete(here).status_code == 204
    UnfinishedBatches(access_of(api)).take_in()
    assert api.store.ids() == access_of(api).batches.ids() == []


@pytest.mark.integration
def test_the_reconciler_waits_for_room_and_refuses_nobody(
    serve: Serve, settings: ServiceSettings, redis: Redis
) -> None:
    api = serve(settings.model_copy(update={"max_queued_jobs": 2}))
    die(api, "accepting", 1)
    redis.delete(LOCK)
    unfinished = UnfinishedBatches(access_of(api))
    unfinished.take_in()
    (batch,) = api.client.get("/v1/batches").json()["batches"]
    assert (batch["counts"]["queued"], batch["counts"]["pending"]) == (2, 1)
    finish(api.store, api.records, api.store.ids()[0], JobState.SUCCEEDED)
    unfinished.take_in()
    found = now(api, batch)
    assert (found["counts"]["queued"], found["counts"]["pending"]) == (2, 0)


@pytest.mark.parametrize("accepted_before", [0, 1])
def test_where_redis_fails_on_the_way(
    api: Api, monkeypatch: pytest.MonkeyPatch, accepted_before: int
) -> None:
    submitted: Callable[..., Any] = taking_in.submitted
    calls = iter(range(9))

    def failing(*given: Any) -> Any:
        if next(calls) >= accepted_before:
            raise RedisError("gone")
        return submitted(*given)

    with monkeypatch.context() as patch:
        patch.setattr(taking_in, "submitted", failing)
        answer = post(api, named(*NAMES), KEY)
    problem_of(answer, 503, ProblemType.UNAVAILABLE)
    assert int(answer.headers["retry-after"]) >= 1
    records = access_of(api).batches.ids()
    assert len(records) == len(api.store.ids()) == accepted_before
    batch = accepted(post(api, named(*NAMES), KEY))
    assert [m["state"] for m in batch["studies"]] == ["queued"] * 3
    assert api.store.ids() == job_ids(batch)


def test_a_full_disk_refuses_what_it_does_not_take(
    api: Api, monkeypatch: pytest.MonkeyPatch
) -> None:
    submitted: Callable[..., Any] = taking_in.submitted
    calls = iter(range(9))

    def full(*given: Any) -> Any:
        if next(calls) >= 1:
            raise OSError(28, "No space left on device")
        return submitted(*given)

    monkeypatch.setattr(taking_in, "submitted", full)
    batch = accepted(post(api, named("a", "b")))
    error = batch["studies"][1]["error"]
    assert (error["type"], error["status"]) == (ProblemType.STORAGE_FULL.uri, 507)
    assert batch["studies"][1]["retry_after_s"] >= 1


def test_without_redis_nothing_is_accepted(
    serve: Serve, settings: ServiceSettings, redis: Redis
) -> None:
    nowhere = {"redis_url": "redis://127.0.0.1:1/0", "redis_timeout_s": 0.2}
    api = serve(settings.model_copy(update=nowhere))
    answer = post(api, named("a"), KEY)
    problem_of(answer, 503, ProblemType.UNAVAILABLE)
    assert int(answer.headers["retry-after"]) >= 1
    assert access_of(api).batches.ids() == []


def test_the_record_is_whole_on_disk_before_the_first_job(
    api: Api, monkeypatch: pytest.MonkeyPatch
) -> None:
    submitted: Callable[..., Any] = taking_in.submitted
    seen: list[BatchRecord] = []

    def watching(access: JobAccess, request: Any, *given: Any) -> Any:
        record = access.batches.read(request.batch_id)
        assert record is not None
        seen.append(record)
        return submitted(access, request, *given)

    monkeypatch.setattr(taking_in, "submitted", watching)
    batch = accepted(post(api, [{"study": STUDY}, {}]))
    (record,) = seen
    assert [request.job_id for request in record.pending] == record.job_ids == job_ids(batch)
    assert record.pending[0].contours is not None


@pytest.mark.integration
def test_one_batch_that_cannot_be_taken_in_holds_up_no_other(
    api: Api, monkeypatch: pytest.MonkeyPatch
) -> None:
    die(api, "writing", 1)
    die_under = {**KEY, "Idempotency-Key": "another night"}
    monkeypatch.setitem(KEY, "Idempotency-Key", die_under["Idempotency-Key"])
    die(api, "accepting", 0)
    for key in api.redis.scan_iter("neuralmri:batch-lock:*"):
        api.redis.delete(key)
    first, second = access_of(api).batches.ids()
    read = JobAccess.of_settings(api.settings).batches.read
    write = taking_in.BatchRecord.after

    def unwritable(record: BatchRecord, *given: Any) -> BatchRecord:
        if record.batch_id == first:
            raise PermissionError(13, "Permission denied")
        return write(record, *given)

    with monkeypatch.context() as patch:
        patch.setattr(BatchRecord, "after", unwritable)
        UnfinishedBatches(access_of(api)).take_in()
    left = [record.pending for record in map(read, (first, second)) if record]
    assert [bool(pending) for pending in left] == [True, False]


@pytest.mark.integration
def test_the_services_own_reconciler_goes_on(
    serve: Serve, settings: ServiceSettings, redis: Redis
) -> None:
    api = serve(settings.model_copy(update={"reconcile_every_s": 0.2}))
    die(api, "accepting", 1)
    redis.delete(LOCK)
    wait_until(lambda: len(api.store.ids()) == len(NAMES))
    (here,) = (b["links"]["self"] for b in api.client.get("/v1/batches").json()["batches"])
    assert api.client.get(here).json()["counts"]["queued"] == len(NAMES)
