"""What holds of a job's folder on a disk: crashes and want of room."""

import os
import resource
import subprocess
import sys
import textwrap
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from jobs.disk_folder import DiskFolder
from jobs.disk_store import DiskStore
from schemas.job import JobState
from schemas.messages import JobRequest
from tests.jobs.test_folder import outcome


@pytest.fixture
def folder(store: DiskStore, request_: JobRequest) -> DiskFolder:
    folder = store.folder(request_.job_id)
    folder.create(request_, {})
    return folder


@pytest.mark.parametrize("die_in", ["copyfile", "fsync", "rename"])
def test_a_crash_while_creating_leaves_no_half_job(
    tmp_path: Path, die_in: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The process is killed inside create; the store then shows no job, and sweeps the rest."""
    program = textwrap.dedent(
        f"""
        import os, shutil, signal, pathlib
        from datetime import UTC, datetime
        from jobs.disk_store import DiskStore
        from schemas.messages import JobRequest

        def die(*args, **kwargs):
            os.kill(os.getpid(), signal.SIGKILL)

        root = pathlib.Path({str(tmp_path)!r})
        (root / "upload").write_bytes(b"x")
        store = DiskStore(root / "jobs")
        request = JobRequest(job_id=store.new_id(), kind="contours", created_at=datetime.now(UTC))
        {{"copyfile": lambda: setattr(shutil, "copyfile", die),
          "fsync": lambda: setattr(os, "fsync", die),
          "rename": lambda: setattr(pathlib.Path, "rename", die)}}[{die_in!r}]()
        store.folder(request.job_id).create(request, {{"sax.nii": root / "upload"}})
        """
    )
    ended = subprocess.run([sys.executable, "-c", program], check=False, capture_output=True)
    assert ended.returncode == -9, ended.stderr
    store = DiskStore(tmp_path / "jobs")
    left = list(store.root.iterdir())
    assert len(left) == 1
    assert store.ids() == []
    store.sweep()
    os.utime(left[0], (0, 0))  # as its age looks after a jump of the clock
    store.sweep()
    assert list(store.root.iterdir()) == left, "it may still be being written"
    now_s = time.monotonic()
    monkeypatch.setattr(time, "monotonic", lambda: now_s + 3601.0)
    store.sweep()
    assert list(store.root.iterdir()) == []


def test_an_erasure_cut_short_is_finished_by_the_sweep(
    store: DiskStore, folder: DiskFolder
) -> None:
    folder.path.rename(store.root / f".erased-{folder.job_id}-0")
    store.sweep()
    assert list(store.root.iterdir()) == []


@contextmanager
def no_room() -> Iterator[None]:
    """Files can be made, but nothing written into them, as on a full disk.

    For a moment only: the limit is the whole process's, the test runner's own output included.
    """
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_full_disk_leaves_no_half_outcome(folder: DiskFolder) -> None:
    before = sorted(folder.path.iterdir())
    with no_room(), pytest.raises(OSError, match="too large"):
        folder.write_outcome(outcome(JobState.SUCCEEDED))
    assert sorted(folder.path.iterdir()) == before
    assert folder.outcome() is None


def test_a_full_disk_is_noticed_and_not_filled_with_probes(store: DiskStore) -> None:
    with no_room():
        trouble = store.trouble()
    assert trouble is not None
    assert list(store.root.iterdir()) == []


def test_a_full_disk_leaves_no_half_job(store: DiskStore, request_: JobRequest) -> None:
    with no_room(), pytest.raises(OSError, match="too large"):
        store.folder(request_.job_id).create(request_, {"sax.nii": b"voxels"})
    assert list(store.root.iterdir()) == []


def test_nothing_but_the_outcome_is_added(folder: DiskFolder) -> None:
    folder.write_outcome(outcome(JobState.SUCCEEDED))
    folder.write_outcome(outcome(JobState.CANCELLED))
    assert {p.name for p in folder.path.iterdir()} == {"request.json", "inputs", "outcome.json"}
