import hashlib
import os
import resource
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

import pytest

from jobs.errors import AlreadyPublished, JobGone
from jobs.folder import JobFolder
from jobs.store import JobStore
from schemas.artifacts import Artifact, Manifest
from schemas.job import JobState
from schemas.messages import JobRequest, Outcome
from schemas.vocabulary import Axes


def outcome(state: JobState, attempt: int = 1) -> Outcome:
    now = datetime.now(tz=UTC)
    return Outcome(state=state, started_at=now, finished_at=now, attempt=attempt)


def fill(staging: Path, content: bytes = b"solid\n") -> Manifest:
    """One artifact in a staging folder, and the manifest that lists it."""
    (staging / "ED_lv_endo.stl").write_bytes(content)
    return Manifest(
        subject_id="case-01",
        axes=Axes.LPS,
        created_at=datetime.now(tz=UTC),
        software="test",
        artifacts=[
            Artifact(
                name="ED_lv_endo.stl",
                media_type="model/stl",
                bytes=len(content),
                sha256=hashlib.sha256(content).hexdigest(),
            )
        ],
    )


@pytest.fixture
def folder(store: JobStore, request_: JobRequest) -> JobFolder:
    folder = store.folder(request_.job_id)
    folder.create(request_, {})
    return folder


def test_what_is_created_is_read_back(
    store: JobStore, request_: JobRequest, tmp_path: Path
) -> None:
    upload = tmp_path / "whatever the client called it.nii.gz"
    upload.write_bytes(b"from a file")
    folder = store.folder(request_.job_id)
    assert not folder.exists()
    folder.create(request_, {"sax.nii.gz": upload, "lax_4ch.nii": b"from memory"})
    assert folder.exists()
    assert folder.request() == request_
    assert folder.input_path("sax.nii.gz").read_bytes() == b"from a file"
    assert folder.input_path("lax_4ch.nii").read_bytes() == b"from memory"
    assert store.ids() == [request_.job_id]


def test_a_job_is_created_once(folder: JobFolder) -> None:
    request = folder.request()
    with pytest.raises(FileExistsError):
        folder.create(request, {"sax.nii": b"another"})
    with pytest.raises(JobGone):
        folder.input_path("sax.nii")


@pytest.mark.parametrize("name", ["../escape", "a/b", "", ".hidden", "a\0b", "..", "a" * 161])
def test_only_plain_names_touch_the_disk(
    store: JobStore,
    request_: JobRequest,
    folder: JobFolder,
    make_request: Callable[[], JobRequest],
    name: str,
) -> None:
    new = make_request()
    with pytest.raises(ValueError, match="plain file name"):
        store.folder(new.job_id).create(new, {name: b""})
    assert not store.folder(new.job_id).exists()
    with pytest.raises(ValueError, match="plain file name"):
        folder.input_path(name)


@pytest.mark.parametrize(
    "job_id", ["", "..", "A" * 32, "0" * 31, "0" * 33, "0" * 32 + "\n", "../x"]
)
def test_only_job_ids_name_folders(store: JobStore, job_id: str) -> None:
    with pytest.raises(ValueError, match="not a job id"):
        store.folder(job_id)


def test_ids_sort_by_the_time_they_were_made(store: JobStore) -> None:
    ids = [store.new_id() for _ in range(2000)]
    assert sorted(set(ids)) == ids


@pytest.mark.parametrize("die_in", ["copyfile", "fsync", "rename"])
def test_a_crash_while_creating_leaves_no_half_job(
    tmp_path: Path, die_in: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The process is killed inside create; the store then shows no job, and sweeps the rest."""
    program = textwrap.dedent(
        f"""
        import os, shutil, signal, pathlib
        from datetime import UTC, datetime
        from jobs.store import JobStore
        from schemas.messages import JobRequest

        def die(*args, **kwargs):
            os.kill(os.getpid(), signal.SIGKILL)

        root = pathlib.Path({str(tmp_path)!r})
        (root / "upload").write_bytes(b"x")
        store = JobStore(root / "jobs")
        request = JobRequest(job_id=store.new_id(), kind="contours", created_at=datetime.now(UTC))
        {{"copyfile": lambda: setattr(shutil, "copyfile", die),
          "fsync": lambda: setattr(os, "fsync", die),
          "rename": lambda: setattr(pathlib.Path, "rename", die)}}[{die_in!r}]()
        store.folder(request.job_id).create(request, {{"sax.nii": root / "upload"}})
        """
    )
    ended = subprocess.run([sys.executable, "-c", program], check=False, capture_output=True)
    assert ended.returncode == -9, ended.stderr
    store = JobStore(tmp_path / "jobs")
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


def test_the_first_publisher_wins(folder: JobFolder) -> None:
    first, second = folder.staging(1), folder.staging(2)
    fill(second, b"the slow one")
    assert folder.manifest() is None
    folder.publish(first, fill(first, b"the fast one"))
    with pytest.raises(AlreadyPublished):
        folder.publish(second, fill(second, b"the slow one"))
    assert folder.artifact_path("ED_lv_endo.stl").read_bytes() == b"the fast one"


def test_staging_is_private_to_an_attempt(folder: JobFolder) -> None:
    assert folder.staging(1) != folder.staging(1)


def test_a_manifest_must_tell_the_truth(folder: JobFolder) -> None:
    staging = folder.staging(1)
    manifest = fill(staging)
    (staging / "ED_lv_endo.stl").write_bytes(b"cut short"[:3])
    with pytest.raises(ValueError, match="3 bytes, not 6"):
        folder.publish(staging, manifest)
    (staging / "ED_lv_endo.stl").unlink()
    with pytest.raises(ValueError, match="missing"):
        folder.publish(staging, manifest)
    assert folder.manifest() is None


def test_only_what_the_manifest_names_is_an_artifact(folder: JobFolder) -> None:
    with pytest.raises(KeyError):
        folder.artifact_path("ED_lv_endo.stl")
    staging = folder.staging(1)
    (staging / "scratch.bin").write_bytes(b"")
    folder.publish(staging, fill(staging))
    for name in ("scratch.bin", "../request.json", "manifest.json", ""):
        with pytest.raises(KeyError):
            folder.artifact_path(name)


def test_the_first_outcome_stands(folder: JobFolder) -> None:
    assert folder.outcome() is None
    first = outcome(JobState.SUCCEEDED)
    assert folder.write_outcome(first) == first
    assert folder.write_outcome(outcome(JobState.CANCELLED)) == first
    assert folder.outcome() == first
    assert {p.name for p in folder.path.iterdir()} == {"request.json", "inputs", "outcome.json"}


def test_erasing_twice_is_erasing_once(store: JobStore, folder: JobFolder) -> None:
    folder.erase()
    folder.erase()
    assert not folder.exists()
    assert list(store.root.iterdir()) == []


def test_a_running_worker_cannot_resurrect_an_erased_job(folder: JobFolder) -> None:
    staging = folder.staging(1)
    manifest = fill(staging)
    folder.erase()
    with pytest.raises(JobGone):
        folder.publish(staging, manifest)
    with pytest.raises(JobGone):
        folder.staging(2)
    with pytest.raises(JobGone):
        folder.write_outcome(outcome(JobState.SUCCEEDED))
    with pytest.raises(JobGone):
        folder.request()
    assert folder.outcome() is None
    assert folder.manifest() is None
    assert not folder.path.exists()


def test_an_erasure_cut_short_is_finished_by_the_sweep(store: JobStore, folder: JobFolder) -> None:
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


def test_a_full_disk_leaves_no_half_outcome(folder: JobFolder) -> None:
    before = sorted(folder.path.iterdir())
    with no_room(), pytest.raises(OSError, match="too large"):
        folder.write_outcome(outcome(JobState.SUCCEEDED))
    assert sorted(folder.path.iterdir()) == before
    assert folder.outcome() is None


def test_a_full_disk_is_noticed_and_not_filled_with_probes(store: JobStore) -> None:
    with no_room():
        is_writable = store.is_writable()
    assert not is_writable
    assert list(store.root.iterdir()) == []


def test_a_full_disk_leaves_no_half_job(store: JobStore, request_: JobRequest) -> None:
    with no_room(), pytest.raises(OSError, match="too large"):
        store.folder(request_.job_id).create(request_, {"sax.nii": b"voxels"})
    assert list(store.root.iterdir()) == []
