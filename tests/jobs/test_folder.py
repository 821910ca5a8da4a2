"""What holds of a job's folder wherever it is kept."""

import hashlib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime
from pathlib import Path

import pytest

from jobs.errors import AlreadyPublished, JobGone
from jobs.folder import JobFolder
from jobs.store import JobStore
from jobs.stored_file import StoredFile
from schemas.artifacts import MANIFEST_NAME, Artifact, Manifest
from schemas.job import JobState
from schemas.messages import JobRequest, Outcome
from schemas.vocabulary import Axes
from tests.stores import remains


@pytest.fixture
def store(any_store: JobStore) -> JobStore:
    return any_store


def read(file: StoredFile) -> bytes:
    with file.open() as opened:
        return opened.read()


def given(folder: JobFolder, name: str) -> bytes:
    """An input as a worker reads it."""
    staging = folder.staging(1)
    try:
        return folder.local_input(name, staging).read_bytes()
    finally:
        folder.drop_staging(staging)


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
    assert given(folder, "sax.nii.gz") == b"from a file"
    assert given(folder, "lax_4ch.nii") == b"from memory"
    assert store.ids() == [request_.job_id]


def test_a_job_is_created_once(folder: JobFolder) -> None:
    request = folder.request()
    with pytest.raises(FileExistsError):
        folder.create(request, {"sax.nii": b"another"})
    with pytest.raises(JobGone):
        folder.stored_input("sax.nii")


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
        folder.stored_input(name)


@pytest.mark.parametrize(
    "job_id", ["", "..", "A" * 32, "0" * 31, "0" * 33, "0" * 32 + "\n", "../x"]
)
def test_only_job_ids_name_folders(store: JobStore, job_id: str) -> None:
    with pytest.raises(ValueError, match="not a job id"):
        store.folder(job_id)


def test_ids_sort_by_the_time_they_were_made(store: JobStore) -> None:
    ids = [store.new_id() for _ in range(2000)]
    assert sorted(set(ids)) == ids


def test_the_first_publisher_wins(folder: JobFolder) -> None:
    first, second = folder.staging(1), folder.staging(2)
    fill(second, b"the slow one")
    assert folder.manifest() is None
    folder.publish(first, fill(first, b"the fast one"))
    with pytest.raises(AlreadyPublished):
        folder.publish(second, fill(second, b"the slow one"))
    assert read(folder.artifact("ED_lv_endo.stl")) == b"the fast one"


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
        folder.artifact("ED_lv_endo.stl")
    staging = folder.staging(1)
    (staging / "scratch.bin").write_bytes(b"")
    folder.publish(staging, fill(staging))
    for name in ("scratch.bin", "../request.json", ""):
        with pytest.raises(KeyError):
            folder.artifact(name)


def test_the_first_outcome_stands(folder: JobFolder) -> None:
    assert folder.outcome() is None
    first = outcome(JobState.SUCCEEDED)
    assert folder.write_outcome(first) == first
    assert folder.write_outcome(outcome(JobState.CANCELLED)) == first
    assert folder.outcome() == first


def test_erasing_twice_is_erasing_once(store: JobStore, folder: JobFolder) -> None:
    folder.erase()
    folder.erase()
    assert not folder.exists()
    assert remains(store) == []


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
    assert not folder.exists()


def test_an_open_file_is_an_input_from_its_start(
    store: JobStore, request_: JobRequest, tmp_path: Path
) -> None:
    (tmp_path / "upload").write_bytes(b"voxels")
    with (tmp_path / "upload").open("rb") as upload:
        upload.read(3)
        folder = store.folder(request_.job_id)
        folder.create(request_, {"sax.nii": upload})
    assert given(folder, "sax.nii") == b"voxels"


def test_an_input_outlives_the_job_that_had_it_first(
    store: JobStore, request_: JobRequest, make_request: Callable[[], JobRequest]
) -> None:
    first, second = store.folder(request_.job_id), make_request()
    first.create(request_, {"sax.nii": b"voxels"})
    stored = first.stored_input("sax.nii")
    store.folder(second.job_id).create(second, {"sax.nii": stored})
    first.erase()
    assert given(store.folder(second.job_id), "sax.nii") == b"voxels"

    third = make_request()
    with pytest.raises(JobGone):
        store.folder(third.job_id).create(third, {"sax.nii": stored})
    assert store.ids() == [second.job_id]


def test_a_published_file_can_be_read_from_anywhere(folder: JobFolder) -> None:
    content = bytes(range(256)) * 5000
    staging = folder.staging(1)
    folder.publish(staging, fill(staging, content))
    file = folder.artifact("ED_lv_endo.stl")
    assert file.bytes == len(content)
    assert abs(file.modified_at_s - datetime.now(UTC).timestamp()) < 60.0
    with file.open() as opened:
        for start, length in ((0, 10), (1_100_000, 5000), (3, 1), (len(content) - 2, 10)):
            opened.seek(start)
            assert opened.read(length) == content[start : start + length]
        assert opened.read(1) == b""


def test_the_manifest_is_served_beside_what_it_lists(folder: JobFolder) -> None:
    with pytest.raises((KeyError, JobGone)):
        folder.artifact(MANIFEST_NAME)
    staging = folder.staging(1)
    manifest = fill(staging)
    folder.publish(staging, manifest)
    file = folder.artifact(MANIFEST_NAME)
    content = read(file)
    assert (Manifest.model_validate_json(content), file.bytes) == (manifest, len(content))


def test_an_empty_file_may_be_a_result(folder: JobFolder) -> None:
    staging = folder.staging(1)
    folder.publish(staging, fill(staging, b""))
    assert read(folder.artifact("ED_lv_endo.stl")) == b""


def test_of_many_publishers_at_once_one_wins(store: JobStore, folder: JobFolder) -> None:
    def publish(number: int) -> bool:
        own = store.folder(folder.job_id)
        staging = own.staging(number)
        try:
            own.publish(staging, fill(staging, b"%d" % number))
        except AlreadyPublished:
            return False
        finally:
            own.drop_staging(staging)
        return True

    with ThreadPoolExecutor(8) as threads:
        won = list(threads.map(publish, range(8)))
    assert won.count(True) == 1
    assert read(folder.artifact("ED_lv_endo.stl")) == b"%d" % won.index(True)
    folder.tidy()
    listed = [name for name in remains(store) if name.endswith("ED_lv_endo.stl")]
    assert len(listed) == 1, "what the others brought is gone"


def test_of_many_outcomes_at_once_one_stands_and_everybody_learns_it(
    store: JobStore, folder: JobFolder
) -> None:
    def write(attempt: int) -> Outcome:
        said = outcome(JobState.SUCCEEDED if attempt % 2 else JobState.FAILED, attempt)
        return store.folder(folder.job_id).write_outcome(said)

    with ThreadPoolExecutor(20) as threads:
        told = list(threads.map(write, range(20)))
    assert told == [folder.outcome()] * 20


def test_a_mark_is_made_once_or_twice_and_never_on_an_erased_job(folder: JobFolder) -> None:
    assert not folder.is_announced()
    folder.mark_announced()
    folder.mark_announced()
    assert folder.is_announced()
    folder.erase()
    assert not folder.is_announced()
    with pytest.raises(JobGone):
        folder.mark_announced()


def test_what_attempts_left_is_tidied_and_results_stay(folder: JobFolder, store: JobStore) -> None:
    staging = folder.staging(1)
    folder.publish(staging, fill(staging))
    before = remains(store)
    (folder.staging(2) / "half.stl").write_bytes(b"half")
    folder.tidy()
    assert remains(store) == before


def test_a_store_takes_files_and_says_so(store: JobStore) -> None:
    store.prove()
    assert store.trouble() is None
    store.space()
    assert remains(store) == []


def test_a_sweep_leaves_jobs_alone(store: JobStore, folder: JobFolder) -> None:
    staging = folder.staging(1)
    folder.publish(staging, fill(staging))
    before = remains(store)
    store.sweep()
    assert remains(store) == before
