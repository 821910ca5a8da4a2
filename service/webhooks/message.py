"""A message as it is stored until it is delivered, and the steps of its life."""

import hashlib
import secrets
from collections.abc import Sequence
from datetime import datetime, timedelta

from schemas.messages import Outcome
from schemas.webhook import (
    TEST_EVENT,
    Delivery,
    DeliveryAttempt,
    DeliveryState,
    EndpointTestData,
    EventLinks,
    JobEvent,
    JobEventData,
    WebhookMessage,
)
from service.webhooks.retry import wait_s

MESSAGE_ID_PATTERN = r"^msg_[0-9a-f]{32}$"

_ATTEMPTS_KEPT = 20


class Message(Delivery):
    """`deliveries/<id>.json`.

    body: the very bytes that are signed and sent, at every attempt.
    tries: attempts since it was made, or sent anew by its owner.
    traceparent: of the request that brought the job.
    """

    body: str
    tries: int = 0
    traceparent: str | None = None

    @classmethod
    def of_job(
        cls,
        endpoint_id: str,
        job_id: str,
        outcome: Outcome,
        now: datetime,
        traceparent: str | None = None,
    ) -> "Message":
        """That a job has ended. The same job and endpoint give the same id, whoever asks, so that
        a receiver can tell a message that comes twice.
        """
        event = JobEvent(f"job.{outcome.state}")
        seed = f"{job_id} {event} {endpoint_id}"
        here = f"/v1/jobs/{job_id}"
        links = EventLinks(self=here, report=f"{here}/report", artifacts=f"{here}/artifacts")
        body = WebhookMessage(
            type=event,
            timestamp=outcome.finished_at,
            data=JobEventData(job_id=job_id, state=outcome.state, links=links),
        )
        return cls(
            id=f"msg_{hashlib.sha256(seed.encode()).hexdigest()[:32]}",
            event=event,
            job_id=job_id,
            created_at=now,
            next_attempt_at=now,
            body=body.model_dump_json(),
            traceparent=traceparent,
        )

    @classmethod
    def of_test(cls, endpoint_id: str, now: datetime) -> "Message":
        body = WebhookMessage(
            type=TEST_EVENT, timestamp=now, data=EndpointTestData(webhook_id=endpoint_id)
        )
        return cls(
            id=f"msg_{secrets.token_hex(16)}",
            event=TEST_EVENT,
            created_at=now,
            next_attempt_at=now,
            body=body.model_dump_json(),
        )

    def public(self) -> Delivery:
        return Delivery(**{name: getattr(self, name) for name in Delivery.model_fields})

    def is_due(self, now: datetime) -> bool:
        return self.next_attempt_at is not None and self.next_attempt_at <= now

    def delivered(self, attempt: DeliveryAttempt) -> "Message":
        return self._after(attempt, DeliveryState.DELIVERED, None)

    def given_up(self, attempt: DeliveryAttempt) -> "Message":
        return self._after(attempt, DeliveryState.FAILED, None)

    def failed(
        self,
        attempt: DeliveryAttempt,
        delays_s: Sequence[float],
        now: datetime,
        *,
        put_off_s: float,
        draw: float,
    ) -> "Message":
        """To be tried again by the schedule, or given up at its end."""
        tries = self.tries + 1
        if tries >= len(delays_s):
            return self.given_up(attempt)
        next_at = now + timedelta(seconds=wait_s(delays_s[tries], put_off_s, draw))
        return self._after(attempt, DeliveryState.PENDING, next_at)

    def replayed(self, now: datetime) -> "Message":
        """To be sent now, whatever became of it before, and by the whole schedule."""
        return self.model_copy(
            update={"state": DeliveryState.PENDING, "next_attempt_at": now, "tries": 0}
        )

    def _after(
        self, attempt: DeliveryAttempt, state: DeliveryState, next_at: datetime | None
    ) -> "Message":
        return self.model_copy(
            update={
                "state": state,
                "next_attempt_at": next_at,
                "attempts": [*self.attempts, attempt][-_ATTEMPTS_KEPT:],
                "tries": self.tries + 1,
            }
        )
