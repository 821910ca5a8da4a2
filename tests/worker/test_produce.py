"""A job that is interrupted, and what becomes of its checkpoints: the same bytes, whatever did."""

import errno
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import pytest

from intake.study import DEFAULT_LIMITS
from jobs import checkpoint_files
from jobs.disk_store import DiskStore
from jobs.folder import JobFolder
from schemas.job import JobKind, Progress
from schemas.messages import ContourRequest, JobRequest
from schemas.options import Options
from worker.observer import Cancelled, Observer, Unobserved
from worker.phantom.standard_study import standard_study
from worker.produce import produce

OPTIONS = Options.model_validate(
    {
        "preset": "fast",
        "levels": 2,
        "iterations_per_level": 60,
        "mesh": {"grid_mm": 4.0},
        "formats": ["stl", "obj"],
    }
)
JOB_ID = "0" * 31 + "1"
"""Said in mesh files: of every job here, so that these are the same bytes."""

MakeJob = Callable[[], JobFolder]


class StopsInTheSecondLevel:
    def __init__(self) -> None:
        self.level: int | None = None

    def advanced(self, progress: Progress) -> None:
        self.level = progress.level

    def is_cancelled(self) -> bool:
        return self.level == 1


@pytest.fixture(scope="module")
def request_() -> JobRequest:
    return JobRequest(
        job_id=JOB_ID,
        kind=JobKind.CONTOURS,
        created_at=datetime.now(UTC),
        contours=ContourRequest(study=standard_study(edge_mm=3.0), options=OPTIONS),
    )


def new_job(root: Path, request: JobRequest) -> JobFolder:
    folder = DiskStore(root).folder(JOB_ID)
    folder.create(request, {})
    return folder


def produced(folder: JobFolder, observer: Observer | None = None) -> dict[str, bytes]:
    staging = folder.staging(1)
    produce(folder, staging, observer or Unobserved(), threads=1, limits=DEFAULT_LIMITS)
    return {path.name: path.read_bytes() for path in staging.glob("ED_*")}


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory: pytest.TempPathFactory, request_: JobRequest) -> dict[str, bytes]:
    found = produced(new_job(tmp_path_factory.mktemp("unbroken") / "jobs", request_))
    assert len(found) == 6
    return found


@pytest.fixture
def interrupted(tmp_path: Path, request_: JobRequest) -> JobFolder:
    folder = new_job(tmp_path / "jobs", request_)
    with pytest.raises(Cancelled):
        produced(folder, StopsInTheSecondLevel())
    assert folder.read_checkpoint("frame-ED-fit") is not None
    return folder


def test_an_interrupted_job_gives_the_bytes_of_an_unbroken_one(
    interrupted: JobFolder, unbroken: dict[str, bytes], caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level("INFO"):
        assert produced(interrupted) == unbroken
    assert "frame-ED-fit is taken up" in caplog.text


@pytest.mark.parametrize("what", ["cut short", "of other code"])
def test_a_checkpoint_that_is_none_costs_its_time_alone(
    interrupted: JobFolder,
    unbroken: dict[str, bytes],
    caplog: pytest.LogCaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
    what: str,
) -> None:
    if what == "cut short":
        held = interrupted.read_checkpoint("frame-ED-fit")
        assert held is not None
        interrupted.write_checkpoint("frame-ED-fit", held[:-100])
    else:
        monkeypatch.setattr("worker.fingerprint.code_sha256", lambda: "of another release")
    assert produced(interrupted) == unbroken
    assert "frame-ED-fit" in caplog.text
    assert "done anew" in caplog.text


def test_a_disk_too_full_for_checkpoints_costs_one_warning(
    tmp_path: Path,
    request_: JobRequest,
    unbroken: dict[str, bytes],
    caplog: pytest.LogCaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(checkpoint_files, "write_durably", full)
    assert produced(new_job(tmp_path / "jobs", request_)) == unbroken
    assert caplog.text.count("no checkpoint is kept") == 1
