import time
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from schemas.job import JobState
from schemas.messages import Outcome
from schemas.webhook import DeliveryAttempt, DeliveryState, WebhookRequest
from service.webhooks.due import DueMessages
from service.webhooks.endpoint import Endpoint
from service.webhooks.endpoints import Endpoints
from service.webhooks.message import Message
from service.webhooks.outbox import Outbox

NOW = datetime(2026, 3, 1, 12, 0, tzinfo=UTC)
DELAYS_S = (0.0, 5.0, 300.0)
OUTCOME = Outcome(state=JobState.SUCCEEDED, started_at=NOW, finished_at=NOW, attempt=1)
ATTEMPT = DeliveryAttempt(at=NOW, duration_s=0.1, status=500, error="the answer was 500")


@pytest.fixture
def endpoint_id(tmp_path: Path) -> str:
    endpoint = Endpoint.of_request(WebhookRequest(url="https://x.org"), "anna", NOW)
    Endpoints(tmp_path).add(endpoint, 1)
    return endpoint.id


@pytest.fixture
def outbox(tmp_path: Path, endpoint_id: str) -> Outbox:
    return Outbox(tmp_path)


def message(number: int = 0, at: datetime = NOW) -> Message:
    return Message.of_job("ep_1", f"{number:032x}", OUTCOME, at)


def failed(before: Message, now: datetime = NOW, put_off_s: float = 0.0) -> Message:
    return before.failed(ATTEMPT, DELAYS_S, now, put_off_s=put_off_s, draw=0.5)


def test_an_id_is_of_job_event_and_endpoint_whenever_it_is_made() -> None:
    later = OUTCOME.model_copy(update={"attempt": 2})
    assert message().id == Message.of_job("ep_1", "0" * 32, later, NOW + timedelta(days=1)).id
    other_end = OUTCOME.model_copy(update={"state": JobState.FAILED})
    ids = {
        message().id,
        message(1).id,
        Message.of_job("ep_2", "0" * 32, OUTCOME, NOW).id,
        Message.of_job("ep_1", "0" * 32, other_end, NOW).id,
        Message.of_test("ep_1", NOW).id,
        Message.of_test("ep_1", NOW).id,
    }
    assert len(ids) == 6


def test_a_message_is_stored_once_and_for_its_endpoint_only(
    outbox: Outbox, endpoint_id: str
) -> None:
    assert outbox.add(endpoint_id, message())
    outbox.change(endpoint_id, message().id, lambda m: m.delivered(ATTEMPT))
    assert not outbox.add(endpoint_id, message(at=NOW + timedelta(hours=1)))
    stored = outbox.get(endpoint_id, message().id)
    assert stored is not None
    assert stored.state is DeliveryState.DELIVERED
    assert not outbox.add("ep_gone", message())
    assert outbox.newest("ep_gone", 10) == []
    assert outbox.change(endpoint_id, "msg_../../endpoint", Message.public) is None  # type: ignore[arg-type]


def test_the_schedule_is_kept_to_its_end() -> None:
    first = failed(message())
    assert first.next_attempt_at == NOW + timedelta(seconds=5)
    second = failed(first)
    assert second.next_attempt_at == NOW + timedelta(seconds=300)
    third = failed(second)
    assert (third.state, third.next_attempt_at) == (DeliveryState.FAILED, None)
    assert len(third.attempts) == 3
    assert failed(message(), put_off_s=60.0).next_attempt_at == NOW + timedelta(seconds=60)


def test_a_replay_begins_the_schedule_anew_and_forgets_no_attempt() -> None:
    given_up = failed(failed(failed(message())))
    again = given_up.replayed(NOW)
    assert again.is_due(NOW)
    assert (again.id, again.body, len(again.attempts)) == (given_up.id, given_up.body, 3)
    assert failed(again).state is DeliveryState.PENDING


def test_attempts_are_kept_to_twenty() -> None:
    often = message()
    for _ in range(30):
        often = failed(often.replayed(NOW))
    assert len(often.attempts) == 20


def test_what_is_due(outbox: Outbox, endpoint_id: str) -> None:
    due = DueMessages(outbox, 10)
    late, later, early = (message(n, NOW + timedelta(seconds=n)) for n in (1, 2, 0))
    for stored in (late, later, early):
        outbox.add(endpoint_id, stored)
    assert due.of(endpoint_id, NOW + timedelta(seconds=1)) == [early.id, late.id]
    outbox.change(endpoint_id, early.id, lambda m: m.delivered(ATTEMPT))
    outbox.change(endpoint_id, late.id, lambda m: failed(m, NOW))
    assert due.of(endpoint_id, NOW + timedelta(seconds=2)) == [later.id]
    outbox.change(endpoint_id, early.id, lambda m: m.replayed(NOW))
    assert due.of(endpoint_id, NOW) == [early.id], "as another process may have asked"
    assert due.of("ep_gone", NOW) == []


def test_ended_messages_are_kept_to_a_number_and_waiting_ones_all(
    outbox: Outbox, endpoint_id: str
) -> None:
    for number in range(8):
        outbox.add(endpoint_id, message(number))
        if number < 6:
            outbox.change(endpoint_id, message(number).id, lambda m: m.delivered(ATTEMPT))
            time.sleep(0.002)
    DueMessages(outbox, 2).of(endpoint_id, NOW)
    left = {stored.id for stored in outbox.newest(endpoint_id, 100)}
    assert left == {message(number).id for number in (4, 5, 6, 7)}
