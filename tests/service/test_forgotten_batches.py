"""A batch's record goes when all its jobs have, no sooner than jobs do; its jobs keep its terms."""

from collections.abc import Callable
from datetime import UTC, datetime, timedelta

from service.access import JobAccess
from service.batches.forgetting import ForgottenBatches
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.service.conftest import Api

Serve = Callable[[ServiceSettings], Api]

DAY = timedelta(days=1)


def forgotten(api: Api, ahead: timedelta) -> int:
    batches = ForgottenBatches(JobAccess.of_settings(api.settings))
    return batches.erase_empty(datetime.now(tz=UTC) + ahead)


def test_a_record_goes_with_its_last_job(settings: ServiceSettings, serve: Serve) -> None:
    api = serve(settings.model_copy(update={"retention_days": 1.0}))
    study = {"study": CONTOUR_REQUEST["study"]}
    batch = api.client.post("/v1/batches/contours", json={"studies": [study]}).json()
    joined = api.client.post(f"/v1/jobs/contours?batch={batch['id']}", json=CONTOUR_REQUEST).json()
    ids = [batch["studies"][0]["job_id"], joined["id"]]
    for job_id in ids:
        assert forgotten(api, 2 * DAY) == 0
        assert api.client.delete(f"/v1/jobs/{job_id}").status_code == 204
    assert forgotten(api, 0.5 * DAY) == 0, "a batch made today may be joined yet"
    assert forgotten(api, 2 * DAY) == 1
    assert api.client.get(f"/v1/batches/{batch['id']}").status_code == 404


def test_records_stay_where_jobs_do(api: Api) -> None:
    made = api.client.post("/v1/batches").json()
    assert forgotten(api, 1000 * DAY) == 0
    assert api.client.get(f"/v1/batches/{made['id']}").is_success


def test_jobs_of_a_batch_are_kept_as_long_as_asked(settings: ServiceSettings, serve: Serve) -> None:
    api = serve(settings.model_copy(update={"retention_days": 1.0}))
    body = {"studies": [{"study": CONTOUR_REQUEST["study"]}]}
    for query, retain_s in (("", 86400.0), ("?retain_s=60", 60.0)):
        batch = api.client.post(f"/v1/batches/contours{query}", json=body).json()
        request = api.store.folder(batch["studies"][0]["job_id"]).request()
        assert request.retain_s == retain_s
        assert request.content_sha256
    assert api.client.post("/v1/batches/contours?retain_s=86401", json=body).status_code == 422
