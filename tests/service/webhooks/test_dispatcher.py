"""The dispatcher without HTTP in front of it, with name servers and disks that misbehave."""

import time
from collections.abc import Callable
from datetime import UTC, datetime

import pytest
from redis import Redis

from schemas.webhook import DeliveryState, WebhookRequest
from service.access import JobAccess
from service.settings import ServiceSettings
from service.webhooks import dispatcher
from service.webhooks.desk import WebhookDesk
from service.webhooks.dispatcher import Dispatcher
from service.webhooks.endpoint import Endpoint
from service.webhooks.message import Message
from service.webhooks.outbox import Outbox
from tests.service.webhooks.receiver import Receiver, Reply


@pytest.fixture
def desk(hook_settings: ServiceSettings) -> WebhookDesk:
    return WebhookDesk.of_settings(hook_settings)


@pytest.fixture
def access(hook_settings: ServiceSettings, redis: Redis) -> JobAccess:
    return JobAccess.of_settings(hook_settings)


def tried(desk: WebhookDesk, url: str) -> tuple[str, str]:
    """An endpoint and a message that waits for it."""
    now = datetime.now(UTC)
    endpoint = Endpoint.of_request(WebhookRequest(url=url), "anonymous", now)
    desk.endpoints.add(endpoint, 10)
    message = Message.of_test(endpoint.id, now)
    desk.outbox.add(endpoint.id, message)
    return endpoint.id, message.id


def wait_until(met: Callable[[], bool], within_s: float = 10.0) -> None:
    deadline = time.monotonic() + within_s
    while not met():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_a_name_that_comes_to_lead_inside_is_refused_at_delivery(
    access: JobAccess, desk: WebhookDesk, receiver: Receiver
) -> None:
    """Public when it was registered, public at the first attempt, and inside from then on."""
    answers = iter(["127.0.0.1"])
    receiver.otherwise = Reply(500)
    endpoint_id, message_id = tried(desk, f"http://hooks.example.org:{receiver.port}/")

    def rebinding(_host: str, _port: int) -> list[str]:
        return [next(answers, "169.254.169.254")]

    def message() -> Message:
        found = desk.outbox.get(endpoint_id, message_id)
        assert found is not None
        return found

    with Dispatcher(access, desk, rebinding):
        wait_until(lambda: message().state is DeliveryState.FAILED)
    first, *others = message().attempts
    assert first.status == 500
    assert len(others) == 3
    for attempt in others:
        assert attempt.status is None
        assert attempt.error is not None
        assert "refused" in attempt.error
        assert "169.254" not in attempt.error, "nor does the log say where the name leads"
    assert len(receiver.received) == 1


def test_an_attempt_that_cannot_be_noted_is_not_repeated_at_once(
    access: JobAccess,
    desk: WebhookDesk,
    receiver: Receiver,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """A disk that is full must not make us flood a receiver."""

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    tried(desk, receiver.url)
    monkeypatch.setattr(dispatcher, "_AFTER_TROUBLE_S", 0.4)
    with monkeypatch.context() as full_disk:
        full_disk.setattr(Outbox, "change", full)
        with Dispatcher(access, desk):
            receiver.wait_for(1)
            time.sleep(0.2)
            assert len(receiver.received) == 1
            assert "was not delivered, or it was not noted" in caplog.text
            full_disk.undo()
            receiver.wait_for(2)
    assert receiver.received[0].id == receiver.received[1].id


def test_it_stops_at_once_whatever_is_under_way(
    access: JobAccess, desk: WebhookDesk, receiver: Receiver, redis: Redis
) -> None:
    receiver.before_reply = lambda: time.sleep(1.5)
    endpoint_id, message_id = tried(desk, receiver.url)
    with Dispatcher(access, desk):
        receiver.wait_for(1)
        start = time.monotonic()
    assert time.monotonic() - start < 1.0
    assert redis.get("neuralmri:webhooks:dispatcher") is None, "the lock is another's to take"
    message = desk.outbox.get(endpoint_id, message_id)
    assert message is not None
    assert message.state is DeliveryState.PENDING


def test_while_another_process_holds_the_lock_it_sends_nothing(
    access: JobAccess, desk: WebhookDesk, receiver: Receiver, redis: Redis
) -> None:
    redis.set("neuralmri:webhooks:dispatcher", "another", px=600)
    tried(desk, receiver.url)
    with Dispatcher(access, desk):
        time.sleep(0.4)
        assert receiver.received == []
        receiver.wait_for(1)
