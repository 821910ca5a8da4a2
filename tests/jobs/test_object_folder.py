"""What holds of a job's folder in a bucket: words that come late, answers that get lost."""

from collections.abc import Callable
from datetime import datetime, timedelta
from unittest.mock import patch

import pytest

from jobs import bucket, object_store
from jobs.bucket import Bucket
from jobs.errors import JobGone
from jobs.object_folder import ObjectFolder
from jobs.object_store import ObjectStore
from jobs.store_errors import StoreMisfit, StoreUnavailable
from schemas.job import JobState
from schemas.messages import JobRequest
from tests.jobs.test_folder import fill, outcome
from tests.s3_server import BUCKET, S3Server
from tests.stores import remains


@pytest.fixture
def store(bucket_store: ObjectStore) -> ObjectStore:
    return bucket_store


@pytest.fixture
def folder(store: ObjectStore, request_: JobRequest) -> ObjectFolder:
    folder = store.folder(request_.job_id)
    folder.create(request_, {"sax.nii": b"voxels"})
    return folder


def erased_right_before(method: str, folder: ObjectFolder) -> Callable[..., object]:
    """The method of a bucket, reached at the very instant of an erasure."""
    real = getattr(Bucket, method)

    def late(bucket: Bucket, *arguments: object) -> object:
        folder.erase()
        return real(bucket, *arguments)

    return late


def test_a_word_that_comes_right_after_an_erasure_is_taken_back(
    store: ObjectStore, folder: ObjectFolder
) -> None:
    with (
        patch.object(Bucket, "put_new", erased_right_before("put_new", folder)),
        pytest.raises(JobGone),
    ):
        folder.write_outcome(outcome(JobState.SUCCEEDED))
    assert remains(store) == []


def test_results_that_come_right_after_an_erasure_are_taken_back(
    store: ObjectStore, folder: ObjectFolder
) -> None:
    staging = folder.staging(1)
    with (
        patch.object(Bucket, "put_new", erased_right_before("put_new", folder)),
        pytest.raises(JobGone),
    ):
        folder.publish(staging, fill(staging))
    assert remains(store) == []


@pytest.mark.parametrize("mark", [ObjectFolder.mark_announced, ObjectFolder.drop_checkpoints])
def test_nothing_else_brings_an_erased_job_back(
    store: ObjectStore, folder: ObjectFolder, mark: Callable[[ObjectFolder], None]
) -> None:
    folder.write_checkpoint("level-2", b"weights")
    with patch.object(Bucket, "put", erased_right_before("put", folder)):
        try:
            mark(folder)
        except JobGone:
            pass
        else:
            folder.erase()
    assert remains(store) == []


def test_a_request_that_was_sent_twice_is_one_word(store: ObjectStore) -> None:
    """botocore sends again what was not answered: the second is refused, though it is ours."""
    assert store.bucket.put_new("key", b"ours")
    assert store.bucket.put_new("key", b"ours")
    assert not store.bucket.put_new("key", b"another's")
    assert store.bucket.get("key") == b"ours"


def test_checkpoints_are_replaced_and_dropped_at_the_end(
    store: ObjectStore, folder: ObjectFolder
) -> None:
    before = remains(store)
    assert folder.read_checkpoint("level-1") is None
    folder.write_checkpoint("level-1", b"first")
    folder.write_checkpoint("level-1", b"second")
    folder.write_checkpoint("level-2", bytes(3 << 20))
    assert folder.read_checkpoint("level-1") == b"second"
    assert folder.read_checkpoint("level-2") == bytes(3 << 20)
    folder.tidy()
    assert remains(store) == before
    folder.erase()
    with pytest.raises(JobGone):
        folder.write_checkpoint("level-1", b"late")
    assert folder.read_checkpoint("level-1") is None
    assert remains(store) == []


def test_what_was_never_shown_is_swept_once_it_is_old(
    store: ObjectStore, folder: ObjectFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = remains(store)
    unseen = store.new_id()
    store.bucket.put(f"jobs/{unseen}/inputs/sax.nii", b"voxels")
    store.bucket.put("probes/1", b"x")
    store.sweep()
    assert len(remains(store)) == len(shown) + 2, "it may still be being written"
    later(monkeypatch)
    store.sweep()
    assert remains(store) == shown


def test_a_worker_killed_right_after_its_late_word_is_swept_after(
    store: ObjectStore, folder: ObjectFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder.erase()
    store.bucket.put_new(f"jobs/{folder.job_id}/outcome.json", b"{}")
    assert store.ids() == []
    assert not folder.exists()
    later(monkeypatch)
    store.sweep()
    assert remains(store) == []


def later(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two hours pass for the sweep."""

    class Later(datetime):
        @classmethod
        def now(cls, tz: object = None) -> datetime:
            return datetime.now(tz) + timedelta(hours=2)  # type: ignore[arg-type]

    monkeypatch.setattr(object_store, "datetime", Later)


def test_a_store_with_more_jobs_than_a_page_lists_them_all(
    store: ObjectStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bucket, "_PAGE", 3)
    ids = [store.new_id() for _ in range(10)]
    for job_id in ids:
        store.bucket.put(f"requests/{job_id}.json", b"{}")
    assert store.ids() == ids


def test_a_store_that_is_down_says_so_everywhere_and_is_no_misfit(
    s3_server: S3Server, store: ObjectStore, folder: ObjectFolder
) -> None:
    s3_server.stop()
    try:
        for step in (folder.exists, folder.outcome, folder.erase, store.ids, store.space):
            with pytest.raises(StoreUnavailable) as said:
                step()
            assert not isinstance(said.value, StoreMisfit)
        assert "does not answer" in str(store.trouble())
        store.prove()
    finally:
        s3_server.start()
    assert folder.exists()


def test_a_submission_that_fails_half_way_leaves_nothing(
    store: ObjectStore, request_: JobRequest
) -> None:
    def lost(*_: object) -> bool:
        raise StoreUnavailable("no answer")

    with patch.object(Bucket, "put_new", lost), pytest.raises(StoreUnavailable):
        store.folder(request_.job_id).create(request_, {"sax.nii": b"voxels"})
    assert remains(store) == []


def test_a_missing_bucket_is_not_taken_for_missing_jobs(s3_server: S3Server) -> None:
    """Or the reconciler would forget them all."""
    none = Bucket(f"no-{BUCKET}", "", 5.0)
    for step in (lambda: none.exists("key"), lambda: none.get("key"), lambda: none.look("key")):
        with pytest.raises(StoreMisfit, match="bucket of NEURALMRI_STORE_URL does not exist"):
            step()


def test_a_store_that_takes_two_first_writers_is_refused(store: ObjectStore) -> None:
    with (
        patch.object(Bucket, "put_new", lambda *_: True),
        pytest.raises(StoreMisfit, match="If-None-Match"),
    ):
        store.prove()


def test_without_credentials_it_says_which_are_missing(
    s3_server: S3Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("AWS_ACCESS_KEY_ID")
    monkeypatch.delenv("AWS_SECRET_ACCESS_KEY")
    monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", "/nowhere")
    monkeypatch.setenv("AWS_CONFIG_FILE", "/nowhere")
    with pytest.raises(StoreMisfit, match="AWS_ACCESS_KEY_ID"):
        Bucket(BUCKET, "", 5.0).get("key")
