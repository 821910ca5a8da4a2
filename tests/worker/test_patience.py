"""An attempt whose store does not answer keeps what it has, for a while."""

from collections.abc import Callable
from pathlib import Path
from unittest.mock import patch

import pytest

from jobs import ending
from jobs.bucket import Bucket
from jobs.errors import JobGone
from jobs.object_folder import ObjectFolder
from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.store import JobStore
from jobs.store_errors import StoreUnavailable
from schemas.artifacts import Manifest
from schemas.job import JobState
from tests.stores import remains
from tests.worker.test_attempt import good, known, never, until_stopped, wrote
from worker.attempt import Desk, Produce, attempt
from worker.observer import KeepsFound, Observer
from worker.patience import patiently
from worker.settings import WorkerSettings


@pytest.fixture
def store(bucket_store: JobStore) -> JobStore:
    return bucket_store


@pytest.fixture
def desk(
    store: JobStore, records: JobRecords, queue: JobQueue, settings: WorkerSettings
) -> Callable[..., Desk]:
    def make(produce: Produce, patience_s: float = 20.0) -> Desk:
        own = settings.model_copy(update={"store_patience_s": patience_s})
        return Desk(store, records, queue, own, produce, never)

    return make


class Failing:
    """A method of the bucket that does not answer the first `times`."""

    def __init__(self, method: str, times: int) -> None:
        self._real = getattr(Bucket, method)
        self.left = times

    def __call__(self, *arguments: object) -> object:
        if self.left > 0:
            self.left -= 1
            raise StoreUnavailable("the store does not answer (ReadTimeoutError)")
        return self._real(*arguments)


def failing(method: str, times: int) -> "patch[object]":  # type: ignore[type-arg]
    fails = Failing(method, times)
    return patch.object(Bucket, method, lambda *arguments: fails(*arguments))


@pytest.mark.parametrize("method", ["put_file", "put_new"])
def test_results_are_brought_once_the_store_is_back(
    method: str, folder: ObjectFolder, records: JobRecords, desk: Callable[..., Desk]
) -> None:
    with failing(method, 2):
        attempt(folder.job_id, desk(good))
    job, outcome = known(records, folder), folder.outcome()
    assert (job.state, job.attempt) == (JobState.SUCCEEDED, 1)
    assert outcome is not None
    with folder.artifact("report.json").open() as file:
        assert file.read() == b"done"


def test_an_attempt_without_patience_left_hands_the_job_back(
    folder: ObjectFolder, records: JobRecords, queue: JobQueue, desk: Callable[..., Desk]
) -> None:
    with failing("put_file", 1000):
        attempt(folder.job_id, desk(good, patience_s=1.0))
    assert (known(records, folder).state, known(records, folder).attempt) == (JobState.QUEUED, 0)
    assert folder.job_id in queue.waiting()
    attempt(folder.job_id, desk(good))
    assert known(records, folder).state is JobState.SUCCEEDED


def test_a_published_job_whose_end_could_not_be_written_is_not_computed_again(
    folder: ObjectFolder, records: JobRecords, desk: Callable[..., Desk]
) -> None:
    fails = Failing("put_new", 1000)
    real = Bucket.put_new

    def only_manifests(bucket: Bucket, key: str, content: bytes) -> object:
        arguments = (bucket, key, content)
        return real(*arguments) if key.endswith("manifest.json") else fails(*arguments)

    with patch.object(Bucket, "put_new", only_manifests):
        attempt(folder.job_id, desk(good, patience_s=1.0))
    assert folder.outcome() is None

    def unwanted(
        folder: ObjectFolder, out_dir: Path, observer: Observer, _: KeepsFound
    ) -> Manifest:
        pytest.fail("the job was computed once too often")

    attempt(folder.job_id, desk(unwanted))
    assert known(records, folder).state is JobState.SUCCEEDED


def test_who_waits_for_the_store_hears_a_cancellation(
    folder: ObjectFolder, records: JobRecords, desk: Callable[..., Desk]
) -> None:
    def is_cancelled(
        folder: ObjectFolder, out_dir: Path, observer: Observer, _: KeepsFound
    ) -> Manifest:
        ending.cancel(folder, records)
        return wrote(out_dir)

    with failing("put_file", 1000):
        attempt(folder.job_id, desk(is_cancelled, patience_s=60.0))
    assert ending.cancel(folder, records) is JobState.CANCELLED


def test_a_job_erased_while_it_runs_leaves_nothing(
    store: JobStore, folder: ObjectFolder, settings: WorkerSettings, desk: Callable[..., Desk]
) -> None:
    def erased(folder: ObjectFolder, out_dir: Path, observer: Observer, _: KeepsFound) -> Manifest:
        folder.erase()
        return wrote(out_dir)

    attempt(folder.job_id, desk(erased))
    assert remains(store) == []
    assert [p.name for p in (settings.data_dir / "scratch").iterdir()] == [".lock"]


def test_a_cancelled_job_leaves_no_results(
    store: JobStore, folder: ObjectFolder, records: JobRecords, desk: Callable[..., Desk]
) -> None:
    def checkpoints(
        folder: ObjectFolder, out_dir: Path, observer: Observer, _: KeepsFound
    ) -> Manifest:
        folder.write_checkpoint("level-1", b"weights")
        ending.cancel(folder, records)
        return until_stopped(folder, out_dir, observer, _)

    attempt(folder.job_id, desk(checkpoints))
    assert known(records, folder).state is JobState.CANCELLED
    named = folder.job_id
    assert remains(store) == [f"jobs/{named}/outcome.json", f"requests/{named}.json"]


def test_patience_is_for_the_store_only() -> None:
    def gone() -> None:
        raise JobGone

    with pytest.raises(JobGone):
        patiently(gone, lambda: False, 60.0)
