from collections.abc import Callable
from datetime import UTC, datetime, timedelta

import pytest

from jobs.disk_store import DiskStore
from jobs.records import JobRecords
from schemas.job import JobKind, JobState
from schemas.messages import JobRequest, Outcome
from schemas.webhook import JobEvent, WebhookRequest
from service.settings import ServiceSettings
from service.webhooks.announcement import Announcer
from service.webhooks.desk import WebhookDesk
from service.webhooks.endpoint import Endpoint

Ended = Callable[..., str]


@pytest.fixture
def desk(settings: ServiceSettings) -> WebhookDesk:
    return WebhookDesk.of_settings(settings)


@pytest.fixture
def ended(store: DiskStore) -> Ended:
    """A job that has ended, `ago_s` ago."""

    def make(state: JobState = JobState.SUCCEEDED, ago_s: float = 0.0) -> str:
        now = datetime.now(UTC)
        request = JobRequest(job_id=store.new_id(), kind=JobKind.CONTOURS, created_at=now)
        folder = store.folder(request.job_id)
        folder.create(request, {})
        at = now - timedelta(seconds=ago_s)
        folder.write_outcome(Outcome(state=state, started_at=None, finished_at=at, attempt=1))
        return request.job_id

    return make


def register(
    desk: WebhookDesk, *events: JobEvent, owner: str = "anonymous", ago_s: float = 10.0
) -> str:
    request = WebhookRequest(url="https://hooks.example.org/", events=list(events or JobEvent))
    at = datetime.now(UTC) - timedelta(seconds=ago_s)
    endpoint = Endpoint.of_request(request, owner, at)
    desk.endpoints.add(endpoint, 100)
    return endpoint.id


def announced(desk: WebhookDesk, endpoint_id: str) -> list[tuple[str | None, str]]:
    return [(m.job_id, m.event) for m in desk.outbox.newest(endpoint_id, 100)]


def announcer(store: DiskStore, desk: WebhookDesk) -> Announcer:
    """As a process that has just started has it."""
    return Announcer(store, desk.endpoints, desk.outbox)


def test_one_message_for_each_endpoint_that_wants_it(
    store: DiskStore, desk: WebhookDesk, ended: Ended
) -> None:
    everything = register(desk)
    failures = register(desk, JobEvent.FAILED)
    others = register(desk, owner="bob")
    succeeded, failed, cancelled = (
        ended(state) for state in (JobState.SUCCEEDED, JobState.FAILED, JobState.CANCELLED)
    )
    for _ in range(2):
        announcer(store, desk).announce()
    assert sorted(announced(desk, everything)) == [
        (succeeded, "job.succeeded"),
        (failed, "job.failed"),
        (cancelled, "job.cancelled"),
    ]
    assert announced(desk, failures) == [(failed, "job.failed")]
    assert announced(desk, others) == []


def test_jobs_that_run_are_looked_at_again(
    store: DiskStore, desk: WebhookDesk, ended: Ended
) -> None:
    endpoint_id = register(desk)
    one = announcer(store, desk)
    now = datetime.now(UTC)
    request = JobRequest(job_id=store.new_id(), kind=JobKind.CONTOURS, created_at=now)
    store.folder(request.job_id).create(request, {})
    one.announce()
    assert announced(desk, endpoint_id) == []
    store.folder(request.job_id).write_outcome(
        Outcome(state=JobState.FAILED, started_at=None, finished_at=now, attempt=1)
    )
    one.announce()
    assert announced(desk, endpoint_id) == [(request.job_id, "job.failed")]


def test_what_ended_before_it_was_registered_is_never_announced(
    store: DiskStore, desk: WebhookDesk, ended: Ended
) -> None:
    job_id = ended(ago_s=20.0)
    first = register(desk)
    for _ in range(2):
        announcer(store, desk).announce()
    assert announced(desk, first) == []
    assert not store.folder(job_id).is_announced()


def test_what_ended_while_it_was_disabled_is_never_announced(
    store: DiskStore, desk: WebhookDesk, ended: Ended
) -> None:
    endpoint_id = register(desk)
    desk.endpoints.change(endpoint_id, lambda e: e.disabled(datetime.now(UTC), "410"))
    ended()
    announcer(store, desk).announce()
    desk.endpoints.change(endpoint_id, Endpoint.enabled)
    announcer(store, desk).announce()
    assert announced(desk, endpoint_id) == []


def test_a_crash_before_the_mark_makes_no_second_message(
    store: DiskStore, desk: WebhookDesk, ended: Ended
) -> None:
    endpoint_id = register(desk)
    job_id = ended()
    announcer(store, desk).announce()
    before = desk.outbox.newest(endpoint_id, 10)
    assert store.folder(job_id).is_announced()
    (store.folder(job_id).path / "announced").unlink()
    announcer(store, desk).announce()
    assert desk.outbox.newest(endpoint_id, 10) == before


def test_erased_jobs_are_not_brought_back(
    store: DiskStore, desk: WebhookDesk, ended: Ended
) -> None:
    register(desk)
    job_id = ended()
    one = announcer(store, desk)
    one.announce()
    store.folder(job_id).erase()
    one.announce()
    assert store.ids() == []


def test_a_service_without_endpoints_leaves_job_folders_alone(
    store: DiskStore, desk: WebhookDesk, ended: Ended, records: JobRecords
) -> None:
    job_id = ended()
    announcer(store, desk).announce()
    left = sorted(path.name for path in store.folder(job_id).path.iterdir())
    assert left == ["inputs", "outcome.json", "request.json"]


@pytest.mark.parametrize("name", ["request.json", "outcome.json"])
def test_a_damaged_job_keeps_no_other_from_being_announced(
    store: DiskStore, desk: WebhookDesk, ended: Ended, name: str
) -> None:
    endpoint = register(desk)
    first, damaged, last = (ended() for _ in range(3))
    (store.folder(damaged).path / name).write_text('{"cut sh')
    announcer(store, desk).announce()
    assert sorted(announced(desk, endpoint)) == [
        (first, "job.succeeded"),
        (last, "job.succeeded"),
    ]
