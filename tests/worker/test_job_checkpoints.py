"""A checkpoint is taken up by another attempt on the same job, and by nothing else."""

import errno
import logging
from collections.abc import Callable
from pathlib import Path

import pytest

from jobs.errors import JobGone
from jobs.folder import JobFolder
from jobs.store import JobStore
from jobs.store_errors import StoreUnavailable
from schemas.options import Options
from worker import fingerprint as fingerprints
from worker.fingerprint import fingerprint
from worker.job_checkpoints import JobCheckpoints
from worker.provenance import provenance

KEY, CONTENT = "frame-ED-fit", b"after level 2" * 1000


def never() -> bool:
    return False


def opened(
    folder: JobFolder, of: str = "this job", is_told_to_stop: Callable[[], bool] = never
) -> JobCheckpoints:
    return JobCheckpoints(folder, of, is_told_to_stop)


@pytest.fixture
def path(folder: JobFolder) -> Path:
    """Where one is kept."""
    opened(folder).save(KEY, CONTENT)
    return folder.path / "checkpoints" / KEY


def test_another_attempt_takes_it_up_and_the_last_one_stands(folder: JobFolder) -> None:
    assert opened(folder).load(KEY) is None
    for content in (b"first", b"", CONTENT):
        opened(folder).save(KEY, content)
        assert opened(folder).load(KEY) == content
    assert opened(folder).load("frame-ES-fit") is None
    assert [file.name for file in (folder.path / "checkpoints").iterdir()] == [KEY]


def test_a_damaged_one_is_refused_with_a_word(
    folder: JobFolder, path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    sound = path.read_bytes()
    flipped = [
        sound[:place] + bytes([sound[place] ^ 1]) + sound[place + 1 :]
        for place in (0, 30, 60, 90, len(sound) // 2, len(sound) - 1)
    ]
    cut = [sound[:size] for size in (0, 1, 30, 60, 90, len(sound) - 1)]
    for damaged in (*flipped, *cut, sound + b"x", b"\0" * len(sound)):
        path.write_bytes(damaged)
        caplog.clear()
        assert opened(folder).load(KEY) is None
        (line,) = caplog.records
        assert line.levelno == logging.WARNING
        assert KEY in line.getMessage()
        assert "done anew" in line.getMessage()
    path.write_bytes(sound)
    assert opened(folder).load(KEY) == CONTENT


def test_one_of_another_job_or_place_is_refused(
    folder: JobFolder, path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    assert opened(folder, "another code version").load(KEY) is None
    path.rename(path.with_name("frame-ES-fit"))
    assert opened(folder).load("frame-ES-fit") is None
    assert caplog.text.count("another input, code or machine") == 2


def test_one_that_cannot_be_read_is_refused(
    folder: JobFolder, path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path.unlink()
    path.mkdir()
    assert opened(folder).load(KEY) is None
    assert "cannot be read" in caplog.text


def test_a_full_disk_costs_a_warning_and_leaves_the_one_before(
    folder: JobFolder,
    path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    checkpoints = opened(folder)
    with monkeypatch.context() as patch:
        patch.setattr("os.fsync", full)
        for _ in range(3):
            checkpoints.save(KEY, b"after level 3")
    assert caplog.text.count("No space left on device") == 1
    assert opened(folder).load(KEY) == CONTENT
    assert [file.name for file in path.parent.iterdir()] == [KEY]
    checkpoints.save(KEY, b"after level 4")
    assert opened(folder).load(KEY) == b"after level 4"


def test_who_is_told_to_stop_writes_nothing(folder: JobFolder, path: Path) -> None:
    opened(folder, is_told_to_stop=lambda: True).save(KEY, b"of an attempt that was overtaken")
    assert opened(folder).load(KEY) == CONTENT


def test_an_erased_job_is_not_resurrected(folder: JobFolder, store: JobStore) -> None:
    folder.erase()
    with pytest.raises(JobGone):
        opened(folder).save(KEY, CONTENT)
    assert list(store.root.iterdir()) == []


def test_whatever_decides_the_result_is_in_the_fingerprint(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    options = Options()
    made_by = provenance(seed=0, threads=1, input_sha256="0" * 64)
    here = fingerprint(options, made_by)
    assert fingerprint(Options(), made_by.model_copy()) == here
    others = [
        fingerprint(options.model_copy(update={"levels": 5}), made_by),
        *(
            fingerprint(options, made_by.model_copy(update=change))
            for change in (
                {"input_sha256": "1" * 64},
                {"threads": 2},
                {"seed": 1},
                {"libraries": {**made_by.libraries, "torch": "0"}},
                {"python": "3.0"},
            )
        ),
    ]
    for of_code_or_machine in ("code_sha256", "processor"):
        with monkeypatch.context() as patch:
            patch.setattr(fingerprints, of_code_or_machine, lambda: "another")
            others.append(fingerprint(options, made_by))
    assert len({here, *others}) == 1 + len(others)


def test_a_bucket_that_is_away_costs_the_checkpoint_alone(
    folder: JobFolder, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def away(*_: object) -> None:
        raise StoreUnavailable("no answer")

    for step in ("read_checkpoint", "write_checkpoint"):
        monkeypatch.setattr(type(folder), step, away)
    checkpoints = opened(folder)
    assert checkpoints.load(KEY) is None
    checkpoints.save(KEY, CONTENT)
    assert "no answer" in caplog.text
