"""What /metrics says of messages whose fate is known."""

from datetime import UTC, datetime, timedelta
from functools import partial

import pytest

from schemas.webhook import DeliveryAttempt, WebhookRequest
from service.settings import ServiceSettings
from service.webhooks.attempt_counts import AttemptCounts
from service.webhooks.desk import WebhookDesk
from service.webhooks.endpoint import Endpoint
from service.webhooks.message import Message
from service.webhooks.metrics import WebhookMetrics
from tests.service.conftest import Api
from tests.service.test_metrics import samples
from tests.service.webhooks.receiver import Receiver, Reply
from tests.service.webhooks.test_dispatcher import wait_until


@pytest.fixture
def desk(settings: ServiceSettings) -> WebhookDesk:
    return WebhookDesk.of_settings(settings)


@pytest.fixture
def metrics(desk: WebhookDesk) -> WebhookMetrics:
    return WebhookMetrics(desk.endpoints, desk.outbox, desk.attempts)


def values(metrics: WebhookMetrics) -> dict[str, float]:
    """By name without the prefix, and label values where there are any."""
    return {
        "/".join([sample.name.removeprefix("neuralmri_webhook_"), *sample.labels.values()]): (
            sample.value
        )
        for family in metrics.collect()
        for sample in family.samples
    }


def endpoint(desk: WebhookDesk) -> str:
    now = datetime.now(UTC)
    made = Endpoint.of_request(WebhookRequest(url="https://hooks.example.org/"), "a", now)
    desk.endpoints.add(made, 10)
    return made.id


def message(desk: WebhookDesk, endpoint_id: str, age_s: float, due_in_s: float) -> str:
    now = datetime.now(UTC)
    made = Message.of_test(endpoint_id, now - timedelta(seconds=age_s)).model_copy(
        update={"next_attempt_at": now + timedelta(seconds=due_in_s)}
    )
    desk.outbox.add(endpoint_id, made)
    return made.id


def test_nothing_waits_where_nothing_is(metrics: WebhookMetrics) -> None:
    assert set(values(metrics).values()) == {0.0}


def test_the_oldest_and_the_most_overdue_are_told(
    desk: WebhookDesk, metrics: WebhookMetrics
) -> None:
    first, second = endpoint(desk), endpoint(desk)
    message(desk, first, age_s=1000.0, due_in_s=500.0)
    late = message(desk, second, age_s=90.0, due_in_s=-60.0)
    found = values(metrics)
    assert found["pending"] == 2.0
    assert 1000.0 <= found["oldest_pending_age_seconds"] < 1060.0
    assert 60.0 <= found["overdue_seconds"] < 120.0
    attempt = DeliveryAttempt(at=datetime.now(UTC), duration_s=0.1, status=204)
    desk.outbox.change(second, late, lambda message: message.delivered(attempt))
    found = values(metrics)
    assert (found["pending"], found["overdue_seconds"]) == (1.0, 0.0)


def test_what_waits_for_a_disabled_endpoint_is_not_overdue(
    desk: WebhookDesk, metrics: WebhookMetrics
) -> None:
    first = endpoint(desk)
    message(desk, first, age_s=1000.0, due_in_s=-500.0)
    now = datetime.now(UTC)
    desk.endpoints.change(first, lambda endpoint: endpoint.disabled(now, "it failed"))
    found = values(metrics)
    assert (found["endpoints/enabled"], found["endpoints/disabled"]) == (0.0, 1.0)
    assert found["pending"] == found["oldest_pending_age_seconds"] == found["overdue_seconds"] == 0


def test_attempts_are_counted_by_what_came_of_them() -> None:
    counts = AttemptCounts()
    now = datetime.now(UTC)
    attempt = DeliveryAttempt(at=now, duration_s=0.1, status=500, error="the answer was 500")
    fails = partial(Message.failed, attempt=attempt, now=now, put_off_s=0.0, draw=0.5)
    made = Message.of_test("ep_1", now)
    once = fails(made, delays_s=(0.0, 5.0))
    for after in (once, fails(once, delays_s=(0.0, 5.0)), once.delivered(attempt)):
        counts.note(after)
    assert counts.totals() == {"delivered": 1, "failed": 1, "given_up": 1}


def test_the_service_counts_what_its_dispatcher_does(hooks: Api, receiver: Receiver) -> None:
    receiver.replies = [Reply(500)]
    made = hooks.client.post("/v1/webhooks", json={"url": receiver.url}).json()
    assert hooks.client.post(f"/v1/webhooks/{made['id']}/test").is_success
    attempts = "neuralmri_webhook_attempts_total"
    wait_until(lambda: samples(hooks)[attempts][("delivered",)] == 1.0)
    found = samples(hooks)
    assert found[attempts] == {("delivered",): 1.0, ("failed",): 1.0, ("given_up",): 0.0}
    assert found["neuralmri_webhook_endpoints"] == {("enabled",): 1.0, ("disabled",): 0.0}
    assert found["neuralmri_webhook_pending"] == {(): 0.0}
