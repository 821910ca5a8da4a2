"""A damaged job of a bucket is moved out of the way whole, and the others go on."""

import json

import pytest

from jobs.bucket import Bucket
from jobs.object_store import ObjectStore
from schemas.messages import JobRequest


@pytest.fixture
def store(bucket_store: ObjectStore) -> ObjectStore:
    return bucket_store


@pytest.fixture
def job_id(bucket_store: ObjectStore, request_: JobRequest) -> str:
    bucket_store.folder(request_.job_id).create(request_, {"sax.nii": b"voxels"})
    return request_.job_id


def kept(bucket: Bucket) -> dict[str, bytes | None]:
    """What lies in the one place of the quarantine, by its name there."""
    found = [listed.key for listed in bucket.under("quarantine/")]
    return {key.split("/", 2)[2]: bucket.get(key) for key in found}


@pytest.mark.parametrize("content", [b"{", b"[]", b'{"job_id": "another"}'])
def test_a_damaged_request_is_kept_with_all_the_job_had(
    bucket_store: ObjectStore, job_id: str, content: bytes
) -> None:
    bucket = bucket_store.bucket
    bucket.put(f"requests/{job_id}.json", content)
    assert bucket_store.set_aside([job_id]) == (job_id,)
    assert bucket_store.ids() == []
    assert list(bucket.under(f"jobs/{job_id}/")) == []
    found = kept(bucket)
    why = json.loads(found.pop("why.json") or b"")
    assert (why["name"], "request.json" in why["why"]) == (job_id, True)
    assert found == {"request.json": content, "inputs/sax.nii": b"voxels"}
    assert bucket_store.quarantined() == 1
    assert bucket_store.set_aside([job_id]) == (), "it is done once"


def test_a_damaged_outcome_is_damage(bucket_store: ObjectStore, job_id: str) -> None:
    bucket_store.bucket.put(f"jobs/{job_id}/outcome.json", b"\0\0")
    assert bucket_store.set_aside([job_id]) == (job_id,)
    assert kept(bucket_store.bucket)["outcome.json"] == b"\0\0"


def test_sound_erased_and_newer_jobs_are_left(
    bucket_store: ObjectStore, job_id: str, request_: JobRequest
) -> None:
    newer = {**json.loads(request_.model_dump_json()), "of_a_later_release": 1}
    assert bucket_store.set_aside([job_id, bucket_store.new_id()]) == ()
    bucket_store.bucket.put(f"requests/{job_id}.json", json.dumps(newer).encode())
    assert bucket_store.set_aside([job_id]) == ()
    assert (bucket_store.ids(), bucket_store.quarantined()) == ([job_id], 0)


def test_what_is_gone_is_told_by_one_listing(bucket_store: ObjectStore, job_id: str) -> None:
    other = bucket_store.new_id()
    assert bucket_store.gone([job_id, other]) == {other}
