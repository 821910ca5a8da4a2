"""What steps are counted as, by the steps themselves."""

from collections.abc import Callable
from datetime import UTC, datetime, timedelta

from redis import Redis

from jobs.records import JobRecords
from jobs.tallies import Tallies, Totals
from schemas.job import JobState, Stage
from schemas.messages import JobRequest, Outcome
from schemas.problem import InputError, Problem, ProblemType

MakeRequest = Callable[[], JobRequest]


def claimed(records: JobRecords, request: JobRequest, lease_s: float = 60.0) -> int:
    token = records.claim(request.job_id, lease_s, 9).token
    assert token is not None
    return token


def outcome(state: JobState, error: Problem | None = None, **stage_s: float) -> Outcome:
    now = datetime.now(tz=UTC)
    stages = {Stage(stage): seconds for stage, seconds in stage_s.items()}
    return Outcome(
        state=state, started_at=now, finished_at=now, attempt=1, error=error, stage_s=stages
    )


def totals(redis: Redis) -> Totals:
    return Tallies(redis).totals()


def test_nothing_has_happened_yet(redis: Redis, records: JobRecords, request_: JobRequest) -> None:
    records.accepted(request_)
    assert totals(redis) == Totals({}, 0, 0, 0, {})


def test_an_end_is_counted_once_with_its_stages(
    redis: Redis, records: JobRecords, request_: JobRequest
) -> None:
    records.accepted(request_)
    token = claimed(records, request_)
    ended = outcome(JobState.SUCCEEDED, fitting=12.0, meshing=0.25)
    for _ in range(2):
        records.finished(request_.job_id, token, ended)
        records.restore(request_, ended)

    found = totals(redis)
    assert found.ended == {("contours", "succeeded", "none"): 1}
    assert (found.attempts, found.workers_lost) == (1, 0)
    assert set(found.stages) == {"waiting", "fitting", "meshing"}
    assert found.stages["fitting"].total_s == 12.0
    assert found.stages["fitting"].cumulative()[-1] == ("+Inf", 1)
    assert ("10", 0) in found.stages["fitting"].cumulative()
    assert ("20", 1) in found.stages["fitting"].cumulative()


def test_how_long_a_job_waited_is_counted_when_it_first_starts(
    redis: Redis, records: JobRecords, request_: JobRequest
) -> None:
    request = request_.model_copy(
        update={"created_at": request_.created_at - timedelta(seconds=90)}
    )
    records.accepted(request)
    claimed(records, request, lease_s=0.0)
    claimed(records, request)
    assert 90 <= totals(redis).stages["waiting"].total_s < 95
    assert totals(redis).stages["waiting"].cumulative()[-1][1] == 1


def test_a_failure_says_whose_fault_it_was(
    redis: Redis, records: JobRecords, make_request: MakeRequest
) -> None:
    error = InputError(ProblemType.TOO_FEW_SLICES, "send more").problem()
    for _ in range(2):
        request = make_request()
        records.accepted(request)
        records.finished(request.job_id, claimed(records, request), outcome(JobState.FAILED, error))
    assert totals(redis).ended == {("contours", "failed", "caller"): 2}


def test_a_worker_is_lost_when_its_job_is_taken_from_it(
    redis: Redis, records: JobRecords, make_request: MakeRequest
) -> None:
    reclaimed, overtaken, cancelled, handed_back = (make_request() for _ in range(4))
    for request in (reclaimed, overtaken, cancelled, handed_back):
        records.accepted(request)
    claimed(records, reclaimed, lease_s=0.0)
    assert records.reclaimed(reclaimed.job_id, 0.0)
    assert totals(redis).workers_lost == 1
    claimed(records, overtaken, lease_s=0.0)
    claimed(records, overtaken)
    assert totals(redis).workers_lost == 2
    claimed(records, cancelled, lease_s=0.0)
    assert records.request_cancel(cancelled.job_id) is JobState.CANCELLED
    assert totals(redis).workers_lost == 3
    records.released(handed_back.job_id, claimed(records, handed_back))
    assert totals(redis).workers_lost == 3, "who hands a job back is not lost"
    assert totals(redis).attempts == 5


def test_what_a_lost_redis_had_counted_is_not_counted_again(
    redis: Redis, records: JobRecords, request_: JobRequest
) -> None:
    ended = outcome(JobState.SUCCEEDED, fitting=12.0)
    records.restore(request_, ended)
    assert totals(redis) == Totals({}, 0, 0, 0, {})


def test_an_end_that_only_the_folder_knew_is_counted_with_its_stages(
    redis: Redis, records: JobRecords, request_: JobRequest
) -> None:
    """Its worker died, or lost Redis, between the outcome and the record."""
    records.accepted(request_)
    claimed(records, request_)
    records.restore(request_, outcome(JobState.SUCCEEDED, fitting=12.0))
    assert totals(redis).ended == {("contours", "succeeded", "none"): 1}
    assert totals(redis).stages["fitting"].total_s == 12.0
