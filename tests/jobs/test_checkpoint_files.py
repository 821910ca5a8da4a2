"""Checkpoints come and go with the work on a job, and leave nothing behind."""

import threading
from collections.abc import Callable
from datetime import UTC, datetime

import pytest

from jobs import checkpoint_files
from jobs.ending import cancel
from jobs.errors import JobGone
from jobs.folder import JobFolder
from jobs.records import JobRecords
from jobs.store import JobStore
from schemas.job import JobState
from schemas.messages import JobRequest, Outcome


@pytest.fixture
def folder(store: JobStore, request_: JobRequest) -> JobFolder:
    folder = store.folder(request_.job_id)
    folder.create(request_, {})
    return folder


def end(folder: JobFolder) -> None:
    now = datetime.now(tz=UTC)
    folder.write_outcome(
        Outcome(state=JobState.SUCCEEDED, started_at=now, finished_at=now, attempt=1)
    )


def names(folder: JobFolder) -> list[str]:
    return sorted(path.name for path in folder.path.iterdir())


def test_what_was_written_last_is_read(folder: JobFolder) -> None:
    assert folder.read_checkpoint("a") is None
    for content in (b"1", b"22", b""):
        folder.write_checkpoint("a", content)
        assert folder.read_checkpoint("a") == content
    assert folder.read_checkpoint("b") is None
    assert names(folder) == ["checkpoints", "inputs", "request.json"]


def test_all_are_dropped_once_and_again(folder: JobFolder) -> None:
    folder.write_checkpoint("a", b"1")
    folder.write_checkpoint("b", b"2")
    for _ in range(2):
        folder.drop_checkpoints()
        assert names(folder) == ["inputs", "request.json"]
    assert folder.read_checkpoint("a") is None


@pytest.mark.parametrize("name", ["", "../request.json", "a/b", ".hidden"])
def test_only_plain_names_are_taken(folder: JobFolder, name: str) -> None:
    with pytest.raises(ValueError, match="not a plain file name"):
        folder.write_checkpoint(name, b"")
    with pytest.raises(ValueError, match="not a plain file name"):
        folder.read_checkpoint(name)


def test_a_job_that_is_gone_takes_and_has_none(folder: JobFolder) -> None:
    folder.erase()
    assert folder.read_checkpoint("a") is None
    with pytest.raises(JobGone):
        folder.write_checkpoint("a", b"1")
    folder.drop_checkpoints()
    assert not folder.path.exists()


def test_a_job_that_has_ended_takes_none(folder: JobFolder) -> None:
    end(folder)
    folder.write_checkpoint("a", b"1")
    assert names(folder) == ["inputs", "outcome.json", "request.json"]


def test_whoever_still_writes_when_the_job_ends_leaves_nothing(
    make_request: Callable[[], JobRequest], store: JobStore
) -> None:
    for _ in range(20):
        request = make_request()
        folder = store.folder(request.job_id)
        folder.create(request, {})
        has_begun, stop = threading.Event(), threading.Event()

        def keep_writing(
            folder: JobFolder = folder,
            has_begun: threading.Event = has_begun,
            stop: threading.Event = stop,
        ) -> None:
            while not stop.is_set():
                folder.write_checkpoint("a", b"1")
                has_begun.set()

        writer = threading.Thread(target=keep_writing)
        writer.start()
        assert has_begun.wait(20.0)
        end(folder)
        folder.drop_checkpoints()
        stop.set()
        writer.join()
        assert names(folder) == ["inputs", "outcome.json", "request.json"]


def test_a_job_that_waits_with_checkpoints_and_is_cancelled_drops_them(
    folder: JobFolder, records: JobRecords, request_: JobRequest
) -> None:
    records.accepted(request_)
    folder.write_checkpoint("a", b"1")
    assert cancel(folder, records) is JobState.CANCELLED
    assert names(folder) == ["inputs", "outcome.json", "request.json"]


def test_a_writer_that_is_killed_leaves_what_was_there(
    folder: JobFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder.write_checkpoint("a", b"1")

    def dies(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(checkpoint_files, "write_durably", dies)
    with pytest.raises(KeyboardInterrupt):
        folder.write_checkpoint("a", b"2")
    assert folder.read_checkpoint("a") == b"1"
