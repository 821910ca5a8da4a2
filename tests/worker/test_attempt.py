"""Every way an attempt on a job can go, against a real Redis and a real folder.

What is computed is a parameter of an attempt, so these computations are the catalogue of faults.
"""

import errno
import json
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import pytest
from celery.exceptions import SoftTimeLimitExceeded
from redis import Redis

from jobs import ending, log_context
from jobs.claim import Refusal
from jobs.folder import JobFolder
from jobs.log_context import LogContext
from jobs.queue import JobQueue
from jobs.reconcile import reconcile
from jobs.records import JobRecords
from jobs.store import JobStore
from jobs.submission import submit
from jobs.trace_context import TraceContext
from schemas.artifacts import Manifest
from schemas.job import Job, JobKind, JobState, Priority, Progress, Stage
from schemas.messages import QUEUES, JobRequest
from schemas.problem import Fault, InputError, ProblemType
from schemas.vocabulary import Axes
from tests.redis_server import RedisServer
from worker.artifacts.manifest import describe
from worker.attempt import Desk, Produce, attempt
from worker.observer import Cancelled, Finishing, KeepsFound, Observer
from worker.settings import WorkerSettings

MakeDesk = Callable[..., Desk]

CODE = "c" * 64


def never() -> bool:
    return False


@pytest.fixture
def desk(
    store: JobStore, records: JobRecords, queue: JobQueue, settings: WorkerSettings
) -> MakeDesk:
    def make(produce: Produce, is_shutting_down: Callable[[], bool] = never) -> Desk:
        return Desk(store, records, queue, settings, produce, is_shutting_down, CODE)

    return make


def wrote(out_dir: Path, text: str = "done") -> Manifest:
    (out_dir / "report.json").write_text(text)
    return describe(
        out_dir,
        subject_id="case-01",
        axes=Axes.LPS,
        software="test",
        created_at=datetime.now(UTC),
    )


def good(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
    observer.advanced(Progress(stage=Stage.FITTING, fraction=0.5))
    return wrote(out_dir)


def until_stopped(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
    """Runs until it is told to stop, and gives up after 20 s."""
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline:
        if observer.is_cancelled():
            raise Cancelled
        time.sleep(0.01)
    return wrote(out_dir)


def unwanted(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
    pytest.fail("the job was computed once too often")


def known(records: JobRecords, folder: JobFolder) -> Job:
    job = records.get(folder.job_id)
    assert job is not None
    return job


def staged(folder: JobFolder) -> list[Path]:
    return list(folder.path.glob("staging-*"))


def test_a_computed_job_is_published_and_succeeds(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    attempt(folder.job_id, desk(good))

    job = known(records, folder)
    outcome, manifest = folder.outcome(), folder.manifest()
    assert outcome is not None
    assert manifest is not None
    assert (job.state, outcome.state) == (JobState.SUCCEEDED, JobState.SUCCEEDED)
    assert (job.progress.fraction, job.progress.stage, job.attempt) == (1.0, Stage.DONE, 1)
    assert outcome.started_at is not None
    assert outcome.started_at <= outcome.finished_at
    assert outcome.code_version == CODE
    assert folder.artifact_path("report.json").read_text() == "done"
    assert staged(folder) == []


def test_progress_is_seen_while_the_job_runs(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    seen: list[Job] = []

    def looks(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        observer.advanced(Progress(stage=Stage.FITTING, fraction=0.25, level=2, iteration=7))
        seen.append(known(records, folder))
        return wrote(out_dir)

    attempt(folder.job_id, desk(looks))

    (job,) = seen
    assert job.state is JobState.RUNNING
    assert (job.progress.fraction, job.progress.level) == (0.25, 2)
    assert job.progress.eta_s is not None


def test_bad_input_fails_the_job_as_the_callers_fault(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    def refuses(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        raise InputError(ProblemType.TOO_FEW_SLICES, "send more slices", pointer="/study/frames/0")

    attempt(folder.job_id, desk(refuses))

    error = known(records, folder).error
    assert error is not None
    assert (error.fault, error.detail) == (Fault.CALLER, "send more slices")
    assert error.pointer == "/study/frames/0"
    assert known(records, folder).state is JobState.FAILED
    assert staged(folder) == []


def test_a_surprise_fails_the_job_as_ours_and_tells_nothing_of_the_inside(
    folder: JobFolder, records: JobRecords, desk: MakeDesk, caplog: pytest.LogCaptureFixture
) -> None:
    def breaks(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        raise ZeroDivisionError("secret inside")

    attempt(folder.job_id, desk(breaks))

    error = known(records, folder).error
    assert error is not None
    assert error.fault is Fault.SERVICE
    assert folder.job_id in error.detail
    assert "secret" not in error.model_dump_json()
    assert "secret inside" in caplog.text, "the operator must find it in the log"


def test_results_that_the_disk_has_no_room_for_fail_the_job_with_a_remedy(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    def too_much(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        raise OSError(errno.ENOSPC, "No space left on device")

    attempt(folder.job_id, desk(too_much))

    job = known(records, folder)
    assert job.state is JobState.FAILED
    assert job.error is not None
    assert job.error.type == ProblemType.STORAGE_FULL.uri
    assert "Erase" in job.error.detail
    assert staged(folder) == []


def test_the_soft_time_limit_fails_the_job_with_a_remedy(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    def overruns(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        raise SoftTimeLimitExceeded

    attempt(folder.job_id, desk(overruns))

    error = known(records, folder).error
    assert error is not None
    assert error.type == ProblemType.TIMED_OUT.uri
    assert "fast" in error.detail


def test_a_cancelled_job_stops_at_once_and_says_so(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    asked_at: list[float] = []

    def is_asked(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        assert ending.cancel(folder, records) is JobState.CANCELLING
        asked_at.append(time.monotonic())
        return until_stopped(folder, out_dir, observer, _)

    attempt(folder.job_id, desk(is_asked))

    assert time.monotonic() - asked_at[0] < 1.0
    assert known(records, folder).state is JobState.CANCELLED
    assert folder.manifest() is None
    assert staged(folder) == []


def until_stopped_keeping(
    folder: JobFolder, out_dir: Path, observer: Observer, keeps: KeepsFound
) -> Manifest:
    """Stops as it is told to, and writes what was found where that is wanted."""
    try:
        return until_stopped(folder, out_dir, observer, keeps)
    except Cancelled:
        if not keeps():
            raise
    if Finishing(observer, keeps).is_cancelled():
        raise Cancelled
    return wrote(out_dir, "a part").model_copy(update={"complete": False})


def test_a_job_cancelled_with_its_frames_to_be_kept_ends_with_what_it_has(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    def is_asked(
        folder: JobFolder, out_dir: Path, observer: Observer, keeps: KeepsFound
    ) -> Manifest:
        assert ending.cancel(folder, records, keeps_frames=True) is JobState.CANCELLING
        return until_stopped_keeping(folder, out_dir, observer, keeps)

    attempt(folder.job_id, desk(is_asked))

    assert known(records, folder).state is JobState.SUCCEEDED
    assert folder.manifest() is not None
    outcome = folder.outcome()
    assert outcome is not None
    assert outcome.code_version is None, "a part of the results is no answer to the same again"


def test_a_plain_cancellation_overrules_one_that_keeps_frames(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    def is_asked_twice(
        folder: JobFolder, out_dir: Path, observer: Observer, keeps: KeepsFound
    ) -> Manifest:
        ending.cancel(folder, records, keeps_frames=True)
        until_it_says_so(observer)
        assert keeps()
        assert not observer.is_cancelled()
        ending.cancel(folder, records)
        until_it_says_so(observer)
        assert Finishing(observer, keeps).is_cancelled()
        raise Cancelled

    attempt(folder.job_id, desk(is_asked_twice))

    assert known(records, folder).state is JobState.CANCELLED
    assert folder.manifest() is None


def until_it_says_so(observer: Observer) -> None:
    deadline = time.monotonic() + 10.0
    while not observer.is_cancelled():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_a_closing_worker_hands_the_job_back_and_another_does_it(
    folder: JobFolder, records: JobRecords, queue: JobQueue, desk: MakeDesk
) -> None:
    attempt(folder.job_id, desk(until_stopped, is_shutting_down=lambda: True))

    assert known(records, folder).state is JobState.QUEUED
    assert known(records, folder).attempt == 0, "a worker's end is no attempt"
    assert folder.job_id in queue.waiting()
    assert folder.outcome() is None
    assert staged(folder) == []

    attempt(folder.job_id, desk(good))
    assert known(records, folder).state is JobState.SUCCEEDED


def test_a_job_that_is_handed_back_keeps_its_priority_and_its_trace(
    store: JobStore, records: JobRecords, queue: JobQueue, desk: MakeDesk, redis: Redis
) -> None:
    request = JobRequest(
        job_id=store.new_id(),
        kind=JobKind.CONTOURS,
        created_at=datetime.now(UTC),
        priority=Priority.BATCH,
    )
    log_context.enter(LogContext(trace=TraceContext.begun()))
    job = submit(store, records, queue, request, {})
    sent = redis.rpop(QUEUES[Priority.BATCH])
    log_context.enter(LogContext(job_id=job.id))

    attempt(job.id, desk(until_stopped, is_shutting_down=lambda: True))

    handed_back = redis.rpop(QUEUES[Priority.BATCH])
    assert isinstance(sent, str)
    assert isinstance(handed_back, str)
    headers = [json.loads(message)["headers"] for message in (sent, handed_back)]
    assert headers[0]["id"] == headers[1]["id"] == job.id
    assert headers[0]["traceparent"] == headers[1]["traceparent"]
    assert job.trace_id
    assert job.trace_id in headers[1]["traceparent"]
    assert queue.depth() == 0


def kept(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
    """Leaves a checkpoint, and then does as the observer says."""
    folder.write_checkpoint("frame-ED-fit", b"level 1")
    if observer.is_cancelled():
        raise Cancelled
    return wrote(out_dir)


def test_checkpoints_stay_while_the_job_is_handed_on_and_go_when_it_ends(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    folder.write_checkpoint("frame-ED-fit", b"level 0")
    attempt(folder.job_id, desk(until_stopped, is_shutting_down=lambda: True))
    assert folder.read_checkpoint("frame-ED-fit") == b"level 0"
    attempt(folder.job_id, desk(kept))
    assert known(records, folder).state is JobState.SUCCEEDED
    assert not (folder.path / "checkpoints").exists()


def test_a_failed_job_leaves_no_checkpoint(folder: JobFolder, desk: MakeDesk) -> None:
    def fails(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        folder.write_checkpoint("frame-ED-fit", b"level 1")
        raise ZeroDivisionError

    attempt(folder.job_id, desk(fails))
    assert sorted(path.name for path in folder.path.iterdir()) == [
        "inputs", "outcome.json", "request.json",
    ]  # fmt: skip


def test_who_lost_the_job_leaves_its_checkpoints_to_the_other(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    def is_overtaken(
        folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound
    ) -> Manifest:
        folder.write_checkpoint("frame-ED-fit", b"level 1")
        records.released(folder.job_id, int(out_dir.name.split("-")[1]))
        assert records.claim(folder.job_id, 60.0, 3).granted
        return until_stopped(folder, out_dir, observer, _)

    attempt(folder.job_id, desk(is_overtaken))
    assert folder.read_checkpoint("frame-ED-fit") == b"level 1"


def test_a_cancellation_wins_over_a_closing_worker(
    folder: JobFolder, records: JobRecords, queue: JobQueue, desk: MakeDesk
) -> None:
    closing: list[bool] = []

    def both(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        ending.cancel(folder, records)
        time.sleep(0.4)
        closing.append(True)
        return until_stopped(folder, out_dir, observer, _)

    attempt(folder.job_id, desk(both, is_shutting_down=lambda: bool(closing)))

    assert known(records, folder).state is JobState.CANCELLED
    assert queue.waiting() == set()


def test_a_long_step_does_not_lose_the_lease(
    folder: JobFolder, records: JobRecords, desk: MakeDesk, settings: WorkerSettings
) -> None:
    refusals: list[Refusal | None] = []

    def silent(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        time.sleep(2.5 * settings.lease_s)
        refusals.append(records.claim(folder.job_id, settings.lease_s, 3).refusal)
        return wrote(out_dir)

    attempt(folder.job_id, desk(silent))

    assert refusals == [Refusal.HELD]
    assert known(records, folder).state is JobState.SUCCEEDED


def test_who_lost_the_job_stops_and_writes_nothing(
    folder: JobFolder, records: JobRecords, desk: MakeDesk, settings: WorkerSettings
) -> None:
    def is_overtaken(
        folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound
    ) -> Manifest:
        # As a stalled host looks from outside: its lease has ended, another worker took the job.
        records.released(folder.job_id, int(out_dir.name.split("-")[1]))
        assert records.claim(folder.job_id, 60.0, 3).granted
        return until_stopped(folder, out_dir, observer, _)

    attempt(folder.job_id, desk(is_overtaken))

    assert known(records, folder).state is JobState.RUNNING
    assert folder.outcome() is None
    assert folder.manifest() is None


@pytest.mark.parametrize("end", ["result", "fault"])
def test_who_lost_the_job_unknowingly_writes_nothing(
    end: str, folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    def is_overtaken(
        folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound
    ) -> Manifest:
        records.released(folder.job_id, int(out_dir.name.split("-")[1]))
        assert records.claim(folder.job_id, 60.0, 3).granted
        if end == "fault":
            raise ZeroDivisionError
        return wrote(out_dir)

    attempt(folder.job_id, desk(is_overtaken))

    assert known(records, folder).state is JobState.RUNNING
    assert folder.outcome() is None
    assert folder.manifest() is None
    assert staged(folder) == []


def test_a_job_that_kills_its_workers_fails_after_the_last_attempt(
    folder: JobFolder, records: JobRecords, desk: MakeDesk, settings: WorkerSettings
) -> None:
    for _ in range(settings.max_attempts):
        assert records.claim(folder.job_id, 0.0, settings.max_attempts).granted

    attempt(folder.job_id, desk(unwanted))

    job = known(records, folder)
    assert job.state is JobState.FAILED
    assert job.error is not None
    assert job.error.type == ProblemType.WORKER_LOST.uri
    assert job.error.fault is Fault.SERVICE


def test_a_message_that_comes_twice_is_done_once(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    attempt(folder.job_id, desk(good))
    outcome = folder.outcome()
    attempt(folder.job_id, desk(unwanted))
    assert folder.outcome() == outcome


def test_a_job_that_another_worker_holds_is_left_alone(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    assert records.claim(folder.job_id, 60.0, 3).granted
    attempt(folder.job_id, desk(unwanted))
    assert known(records, folder).state is JobState.RUNNING


def test_an_unknown_job_is_dropped(store: JobStore, desk: MakeDesk) -> None:
    job_id = store.new_id()
    attempt(job_id, desk(unwanted))
    assert not store.folder(job_id).exists()


@pytest.mark.parametrize("attempts_before", [0, 2], ids=["first attempt", "last attempt"])
@pytest.mark.parametrize("requeued", [False, True])
def test_results_of_a_worker_that_died_before_it_could_say_so_stand(
    folder: JobFolder, records: JobRecords, desk: MakeDesk, attempts_before: int, requeued: bool
) -> None:
    for _ in range(attempts_before + 1):
        claim = records.claim(folder.job_id, 0.0, 3)
    assert claim.token is not None
    staging = folder.staging(claim.token)
    folder.publish(staging, wrote(staging, "first"))
    assert not requeued or records.reclaimed(folder.job_id, 0.0)

    attempt(folder.job_id, desk(unwanted))

    assert known(records, folder).state is JobState.SUCCEEDED
    assert folder.artifact_path("report.json").read_text() == "first"
    outcome = folder.outcome()
    assert outcome is not None
    assert outcome.code_version is None, "which code the first worker had is not known"


def test_what_a_killed_attempt_left_behind_is_removed(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    claim = records.claim(folder.job_id, 0.0, 3)
    assert claim.token is not None
    (folder.staging(claim.token) / "half.stl").write_bytes(b"half")

    attempt(folder.job_id, desk(good))

    assert staged(folder) == []
    assert known(records, folder).attempt == 2


def test_an_erased_job_is_not_resurrected(
    folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    def is_erased(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        ending.erase(folder, records)
        return wrote(out_dir)

    attempt(folder.job_id, desk(is_erased))

    assert not folder.path.exists()
    assert records.get(folder.job_id) is None


def test_a_redis_that_is_away_for_a_while_costs_nothing(
    redis_server: RedisServer, folder: JobFolder, records: JobRecords, desk: MakeDesk
) -> None:
    def outlives(folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        redis_server.freeze()
        observer.advanced(Progress(stage=Stage.FITTING, fraction=0.5))
        assert not observer.is_cancelled()
        redis_server.thaw()
        return wrote(out_dir)

    attempt(folder.job_id, desk(outlives))

    assert known(records, folder).state is JobState.SUCCEEDED


def test_a_redis_that_is_gone_at_the_end_leaves_the_job_to_the_reconciler(
    redis_server: RedisServer,
    folder: JobFolder,
    store: JobStore,
    records: JobRecords,
    queue: JobQueue,
    desk: MakeDesk,
) -> None:
    def loses_redis(
        folder: JobFolder, out_dir: Path, observer: Observer, _: KeepsFound
    ) -> Manifest:
        redis_server.kill()
        return wrote(out_dir)

    attempt(folder.job_id, desk(loses_redis))
    assert folder.outcome() is None

    redis_server.start()  # without any memory
    reconcile(store, records, queue, lost_after_s=0.0)
    assert folder.job_id in queue.waiting()
    attempt(folder.job_id, desk(good))
    assert known(records, folder).state is JobState.SUCCEEDED
