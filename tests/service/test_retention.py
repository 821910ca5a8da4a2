"""Expired jobs are erased once, with proof; nothing is while the clock is in doubt."""

import shutil
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from typing import Any
from unittest.mock import patch

import pytest

from jobs.disk_folder import DiskFolder
from jobs.reconcile import reconcile
from jobs.store_errors import StoreUnavailable
from schemas.job import JobState
from schemas.messages import JobRequest, Outcome
from schemas.problem import ProblemType
from service.access import JobAccess
from service.audit_log import AuditLog
from service.audit_search import entries_about
from service.clocks import Clocks
from service.examples import CONTOUR_REQUEST
from service.retention import ACTOR, Retention
from service.settings import ServiceSettings
from tests.service.conftest import Api
from tests.service.jobs_done import claim
from tests.service.test_jobs import problem_of


def submitted(api: Api, retain_s: int | None = 60) -> str:
    query = {} if retain_s is None else {"retain_s": retain_s}
    answer = api.client.post("/v1/jobs/contours", params=query, json=CONTOUR_REQUEST)
    assert answer.status_code == 202, answer.text
    job_id: str = answer.json()["id"]
    return job_id


def ended(api: Api, job_id: str, ago: timedelta) -> str:
    token = claim(api.records, job_id)
    then = datetime.now(tz=UTC) - ago
    outcome = Outcome(state=JobState.FAILED, started_at=then, finished_at=then, attempt=1)
    api.records.finished(job_id, token, api.store.folder(job_id).write_outcome(outcome))
    return job_id


def retention(api: Api) -> Retention:
    return Retention(JobAccess.of_settings(api.settings), AuditLog.of_settings(api.settings))


LONG = timedelta(hours=1)


def proofs(api: Api, job_id: str) -> list[Any]:
    found = entries_about(api.settings.data_dir / "audit", job_id)
    return [entry for entry in found if entry.actor == ACTOR]


def test_a_job_expires_so_long_after_its_end(api: Api) -> None:
    old, fresh = ended(api, submitted(api), LONG), ended(api, submitted(api), timedelta(0))
    kept, waiting = ended(api, submitted(api, None), LONG), submitted(api)
    told = api.client.get(f"/v1/jobs/{old}").json()
    ends, expires = (datetime.fromisoformat(told[k]) for k in ("finished_at", "expires_at"))
    assert expires - ends == timedelta(seconds=60)
    for job_id in (kept, waiting):
        assert api.client.get(f"/v1/jobs/{job_id}").json()["expires_at"] is None
    assert retention(api).erase_expired() == 1
    assert api.store.ids() == sorted([fresh, kept, waiting])
    assert api.client.get(f"/v1/jobs/{old}").status_code == 404
    assert api.client.delete(f"/v1/jobs/{old}").status_code == 204
    (proof,) = proofs(api, old)
    assert (proof.action, proof.outcome, proof.owner) == ("erase", "done", "anonymous")
    assert (proof.ended_at, proof.expires_at) == (ends, expires)
    assert "neuralmri_jobs_expired_total 1.0" in api.client.get("/metrics").text
    assert retention(api).erase_expired() == 0
    assert len(proofs(api, old)) == 1


def test_expiry_is_known_again_after_the_loss_of_redis(api: Api) -> None:
    old = ended(api, submitted(api), LONG)
    api.redis.flushall()
    assert retention(api).erase_expired() == 0
    access = JobAccess.of_settings(api.settings)
    reconcile(access.store, access.records, access.queue, 30.0)
    assert retention(api).erase_expired() == 1
    assert not api.store.folder(old).exists()


def test_many_processes_erase_each_job_without_a_fault(api: Api) -> None:
    old = [ended(api, submitted(api), LONG) for _ in range(8)]
    with ThreadPoolExecutor(4) as threads:
        erased = list(threads.map(lambda _: retention(api).erase_expired(), range(4)))
    assert sum(erased) >= len(old)
    assert api.store.ids() == []
    assert all(proofs(api, job_id) for job_id in old)


def test_the_folder_has_the_last_word(api: Api) -> None:
    fresh = ended(api, submitted(api), timedelta(0))
    api.redis.zadd("neuralmri:expiry", {fresh: 1.0})
    assert retention(api).erase_expired() == 0
    assert api.store.folder(fresh).exists()
    assert api.redis.zscore("neuralmri:expiry", fresh) != 1.0


@pytest.mark.parametrize("ahead_s", [3600.0, -3600.0, 365 * 86400.0])
def test_a_clock_that_jumps_erases_nothing(
    api: Api, monkeypatch: pytest.MonkeyPatch, ahead_s: float
) -> None:
    old = ended(api, submitted(api), LONG)
    erasing = retention(api)
    now = time.time
    monkeypatch.setattr(time, "time", lambda: now() + ahead_s)
    assert erasing.erase_expired() == 0
    assert api.store.folder(old).exists()
    monkeypatch.undo()
    assert erasing.erase_expired() == 1


def test_clocks_that_disagree_are_not_believed() -> None:
    clocks = Clocks()
    now = datetime.now(tz=UTC)
    assert clocks.doubt(now) is None
    assert clocks.doubt(now + timedelta(minutes=1)) is None
    assert "Remedy" in str(clocks.doubt(now + timedelta(days=365)))


def test_a_caller_may_ask_for_less_than_the_service_keeps_never_for_more(
    settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> None:
    api = serve(settings.model_copy(update={"retention_days": 1.0}))
    jobs = [(submitted(api, None), 86400.0), (submitted(api, 3600), 3600.0)]
    for job_id, retain_s in jobs:
        assert api.store.folder(job_id).request().retain_s == retain_s
    answer = api.client.post("/v1/jobs/contours?retain_s=86401", json=CONTOUR_REQUEST)
    assert problem_of(answer, 422, ProblemType.INVALID_REQUEST).pointer == "/query/retain_s"


@pytest.mark.parametrize("text", ["{", "[]"])
def test_a_damaged_job_keeps_no_other_from_being_erased(api: Api, text: str) -> None:
    damaged, old = (ended(api, submitted(api), LONG) for _ in range(2))
    before = api.store.quarantined()
    (api.store.folder(damaged).path / "request.json").write_text(text)
    assert retention(api).erase_expired() == 1
    assert not api.store.folder(old).exists()
    assert api.store.quarantined() == before + 1
    assert api.records.get(damaged) is None
    shutil.rmtree(api.settings.data_dir / "quarantine")  # others count it too


def test_a_job_that_cannot_be_read_now_waits(api: Api) -> None:
    away, old = (ended(api, submitted(api), LONG) for _ in range(2))
    real = DiskFolder.request

    def request(folder: DiskFolder) -> JobRequest:
        if folder.job_id == away:
            raise StoreUnavailable("away")
        return real(folder)

    with patch.object(DiskFolder, "request", request):
        assert retention(api).erase_expired() == 1
    assert not api.store.folder(old).exists()
    assert retention(api).erase_expired() == 1
