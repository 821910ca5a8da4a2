"""The bounds and the idempotency keys, asked for by many at once."""

import threading
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import pytest
from redis import Redis

from jobs import admission as admission_module
from jobs.admission import Admission, Verdict
from jobs.records import JobRecords
from schemas.messages import ANONYMOUS, Idempotency, JobRequest

MakeRequest = Callable[[], JobRequest]


def keyed(request: JobRequest, key: str = "k", payload: str = "p") -> JobRequest:
    return request.model_copy(update={"idempotency": Idempotency(key=key, payload_sha256=payload)})


def verdict(admission: Admission, request: JobRequest, owner: str = ANONYMOUS) -> Verdict:
    return admission.ask(request, owner).verdict


@pytest.mark.parametrize("bound", [1, 7])
def test_the_bound_holds_however_many_ask(
    redis: Redis, records: JobRecords, make_request: MakeRequest, bound: int
) -> None:
    """Half of those admitted become jobs, and the others give up; never is there one too many."""
    admission = Admission(redis, bound, None)
    most: list[int] = []
    lock = threading.Lock()
    inside = 0

    def come(number: int) -> Verdict:
        nonlocal inside
        request = make_request()
        said = verdict(admission, request)
        if said is Verdict.ADMITTED:
            with lock:
                inside += 1
                most.append(inside)
            if number % 2:
                records.accepted(request)
            else:
                with lock:
                    inside -= 1
                admission.withdraw(request, ANONYMOUS)
        return said

    with ThreadPoolExecutor(16) as pool:
        said = Counter(pool.map(come, range(200)))
    queued = len(records.ids())
    assert max(most) <= bound
    assert queued <= bound
    assert said.keys() <= {Verdict.ADMITTED, Verdict.QUEUE_FULL}
    assert redis.keys("neuralmri:places*") == []
    while verdict(admission, request := make_request()) is Verdict.ADMITTED:
        records.accepted(request)
        queued += 1
    assert queued == len(records.ids()) == bound


def test_only_queued_jobs_count_and_only_until_they_start(
    redis: Redis, records: JobRecords, make_request: MakeRequest
) -> None:
    admission = Admission(redis, 2, None)
    requests = [make_request() for _ in range(2)]
    for request in requests:
        assert verdict(admission, request) is Verdict.ADMITTED
        records.accepted(request)
    assert verdict(admission, make_request()) is Verdict.QUEUE_FULL
    records.claim(requests[0].job_id, 60.0, 3)
    assert verdict(admission, make_request()) is Verdict.ADMITTED
    assert verdict(admission, make_request()) is Verdict.QUEUE_FULL, "a place held counts"
    records.request_cancel(requests[1].job_id)
    assert verdict(admission, make_request()) is Verdict.ADMITTED


def test_an_owner_is_bounded_by_its_unfinished_jobs_and_nobody_elses(
    redis: Redis, records: JobRecords, make_request: MakeRequest
) -> None:
    admission = Admission(redis, 100, 2)
    first, second = make_request(), make_request()
    for request in (first, second):
        assert verdict(admission, request, "a") is Verdict.ADMITTED
        records.accepted(request.model_copy(update={"owner": "a"}))
    records.claim(first.job_id, 60.0, 3)
    assert verdict(admission, make_request(), "a") is Verdict.TOO_MANY_JOBS
    assert verdict(admission, make_request(), "b") is Verdict.ADMITTED
    records.request_cancel(first.job_id)
    assert verdict(admission, make_request(), "a") is Verdict.TOO_MANY_JOBS, "its worker goes on"
    records.forget(first.job_id)
    assert verdict(admission, make_request(), "a") is Verdict.ADMITTED
    assert verdict(admission, make_request(), "a") is Verdict.TOO_MANY_JOBS


def test_one_key_admits_one_of_many(redis: Redis, make_request: MakeRequest) -> None:
    admission = Admission(redis, 100, None)
    requests = [keyed(make_request()) for _ in range(40)]
    with ThreadPoolExecutor(16) as pool:
        answers = list(pool.map(lambda request: admission.ask(request, ANONYMOUS), requests))
    said = Counter(answer.verdict for answer in answers)
    assert said == {Verdict.ADMITTED: 1, Verdict.KEY_PENDING: 39}
    winner = requests[[a.verdict for a in answers].index(Verdict.ADMITTED)]
    assert {a.holder for a in answers if a.holder} == {winner.job_id}


def test_a_key_is_known_until_its_job_is_forgotten(
    redis: Redis, records: JobRecords, make_request: MakeRequest
) -> None:
    admission = Admission(redis, 1, 1)
    first = keyed(make_request())
    assert verdict(admission, first) is Verdict.ADMITTED
    records.accepted(first)
    again = keyed(make_request(), payload="other")
    answer = admission.ask(again, ANONYMOUS)
    assert answer == admission_module.Answer(Verdict.KEY_KNOWN, first.job_id, "p"), "full or not"
    assert verdict(admission, again, "somebody else") is Verdict.QUEUE_FULL
    records.request_cancel(first.job_id)
    assert verdict(admission, again) is Verdict.KEY_KNOWN, "also when it has ended"
    records.forget(first.job_id)
    assert redis.keys("neuralmri:idempotency:*") == []
    assert verdict(admission, again) is Verdict.ADMITTED


def test_withdrawing_leaves_nothing(redis: Redis, make_request: MakeRequest) -> None:
    admission = Admission(redis, 1, None)
    request, loser = keyed(make_request()), keyed(make_request())
    assert verdict(admission, request) is Verdict.ADMITTED
    admission.withdraw(loser, ANONYMOUS)
    assert verdict(admission, loser) is Verdict.KEY_PENDING, "nobody withdraws another's"
    admission.withdraw(request, ANONYMOUS)
    assert redis.keys("*") == []
    assert verdict(admission, loser) is Verdict.ADMITTED


def test_who_dies_with_a_place_loses_it(
    redis: Redis, make_request: MakeRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(admission_module, "_PLACE_S", 0)
    admission = Admission(redis, 1, 1)
    for _ in range(3):
        assert verdict(admission, make_request()) is Verdict.ADMITTED
