"""The service over a bucket, where it is not the same as over a disk."""

from collections.abc import Callable
from unittest.mock import patch

import pytest

from jobs.bucket import Bucket
from jobs.store_errors import StoreMisfit, StoreUnavailable
from schemas.job import JobState
from schemas.problem import ProblemType
from service import process
from service.settings import ServiceSettings
from tests.s3_server import BUCKET, S3Server
from tests.service.conftest import Api
from tests.service.jobs_done import finish
from tests.service.test_jobs import problem_of, submitted
from tests.stores import remains
from tests.studies.ellipsoid import good_request


def lost(*_: object, **__: object) -> None:
    raise StoreUnavailable("the store does not answer (ConnectTimeoutError)")


def test_a_submission_without_a_store_is_refused_and_its_place_is_free(
    serve: Callable[[ServiceSettings], Api], s3_server: S3Server, bucket_api: Api
) -> None:
    narrow = {"store_url": f"s3://{BUCKET}", "max_queued_jobs": 1}
    api = serve(bucket_api.settings.model_copy(update=narrow))
    with patch.object(Bucket, "put_new", lost):
        for _ in range(2):
            answer = api.client.post("/v1/jobs/contours", json=good_request())
            problem = problem_of(answer, 503, ProblemType.STORE_UNAVAILABLE)
            assert int(answer.headers["retry-after"]) > 0
            assert "Timeout" not in problem.detail, "what failed is for operators"
    assert remains(api.store) == []
    assert api.records.ids() == []
    assert submitted(api)


@pytest.mark.parametrize("method", ["GET", "DELETE"])
def test_a_job_cannot_be_asked_for_without_a_store(bucket_api: Api, method: str) -> None:
    job_id = submitted(bucket_api)
    with patch.object(Bucket, "get_range", lost):
        answer = bucket_api.client.request(method, f"/v1/jobs/{job_id}")
    problem_of(answer, 503, ProblemType.STORE_UNAVAILABLE)
    assert bucket_api.client.get(f"/v1/jobs/{job_id}").is_success


def test_readiness_needs_the_bucket_and_says_why_not(bucket_api: Api) -> None:
    bucket_api.workers.heartbeat("worker@test")
    bucket_api.workers.finished_heartbeat()
    assert bucket_api.client.get("/readyz").is_success
    with patch.object(Bucket, "put", lost):
        problem = problem_of(bucket_api.client.get("/readyz"), 503, ProblemType.UNAVAILABLE)
    assert [part.pointer for part in problem.errors] == ["store"]
    assert "ConnectTimeoutError" in problem.detail


def test_metrics_know_no_room_but_whether_it_answers(bucket_api: Api) -> None:
    text = bucket_api.client.get("/metrics").text
    assert "neuralmri_store_up 1.0" in text
    assert "neuralmri_store_free_bytes" not in text
    with patch.object(Bucket, "get_range", lost):
        assert "neuralmri_store_up 0.0" in bucket_api.client.get("/metrics").text


def test_erasing_leaves_nothing(bucket_api: Api) -> None:
    job_id = submitted(bucket_api)
    finish(bucket_api.store, bucket_api.records, job_id, JobState.SUCCEEDED)
    assert bucket_api.client.delete(f"/v1/jobs/{job_id}").status_code == 204
    assert remains(bucket_api.store) == []
    problem_of(bucket_api.client.get(f"/v1/jobs/{job_id}"), 404, ProblemType.NOT_FOUND)


def test_a_job_is_done_anew_from_what_the_bucket_has(bucket_api: Api) -> None:
    job_id = submitted(bucket_api)
    finish(bucket_api.store, bucket_api.records, job_id, JobState.SUCCEEDED)
    again = bucket_api.client.post(f"/v1/jobs/{job_id}/restart")
    assert again.status_code == 202
    before, after = (bucket_api.store.folder(i).request() for i in (job_id, again.json()["id"]))
    assert after.contours == before.contours


def test_a_store_that_could_never_keep_a_job_ends_the_start(
    s3_server: S3Server, settings: ServiceSettings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NEURALMRI_STORE_URL", "s3://no-such-bucket/here")
    monkeypatch.setenv("NEURALMRI_DATA_DIR", str(settings.data_dir))
    monkeypatch.setattr(process, "write_logs", lambda *_: None)
    with pytest.raises(SystemExit, match="bucket of NEURALMRI_STORE_URL does not exist") as ended:
        process.app_of_process()
    assert isinstance(ended.value.__cause__, StoreMisfit)


@pytest.mark.parametrize("url", ["s3://", "gs://bucket", "/a/path", "s3://UPPER/x", "bucket"])
def test_only_a_bucket_may_be_named(url: str) -> None:
    with pytest.raises(ValueError, match="store_url"):
        ServiceSettings(store_url=url)
