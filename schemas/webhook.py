"""Webhooks as their owner sees them, and what they carry: that a job has ended, nothing of whom."""

from datetime import datetime
from enum import StrEnum

from pydantic import Field

from schemas.base import WireModel
from schemas.job import JobState


class JobEvent(StrEnum):
    """What an endpoint may be told."""

    SUCCEEDED = "job.succeeded"
    FAILED = "job.failed"
    CANCELLED = "job.cancelled"


TEST_EVENT = "webhook.test"
"""Sent when its owner asks for it; no endpoint needs to name it."""


class WebhookRequest(WireModel):
    """The body of `POST /v1/webhooks`."""

    url: str = Field(min_length=1, max_length=2048, description="Where to POST; https.")
    events: list[JobEvent] = Field(
        default_factory=lambda: list(JobEvent), min_length=1, max_length=len(JobEvent)
    )
    label: str | None = Field(default=None, max_length=200, description="For its owner's eyes.")


class Webhook(WireModel):
    """One registered endpoint."""

    id: str
    url: str
    events: list[JobEvent]
    label: str | None = None
    created_at: datetime
    disabled_at: datetime | None = Field(
        default=None, description="Nothing is sent from then on, until it is enabled."
    )
    disabled_because: str | None = None


class WebhookWithSecret(Webhook):
    """An endpoint with its newest signing secret, which is shown this once."""

    secret: str = Field(description="`whsec_` and base64: what its messages are signed with.")


class WebhookList(WireModel):
    """The caller's endpoints, oldest first."""

    webhooks: list[Webhook]


class DeliveryState(StrEnum):
    """Where a message stands."""

    PENDING = "pending"
    DELIVERED = "delivered"
    FAILED = "failed"


class DeliveryAttempt(WireModel):
    """One try at sending a message."""

    at: datetime
    duration_s: float = Field(ge=0.0)
    status: int | None = Field(default=None, description="Of the answer; null where none came.")
    answer: str | None = Field(default=None, description="The first 200 bytes of its body.")
    error: str | None = Field(default=None, description="Why it does not count.")


class Delivery(WireModel):
    """One message to one endpoint. `id` is its `webhook-id`, the same at every attempt."""

    id: str
    event: str
    job_id: str | None = None
    created_at: datetime
    state: DeliveryState = DeliveryState.PENDING
    next_attempt_at: datetime | None = None
    attempts: list[DeliveryAttempt] = Field(
        default_factory=list, description="The last 20, oldest first."
    )


class DeliveryList(WireModel):
    """An endpoint's messages, newest first."""

    deliveries: list[Delivery]


class EventLinks(WireModel):
    """Where to go from an event."""

    self: str
    report: str
    artifacts: str


class JobEventData(WireModel):
    """The job that ended; whose heart it was is only said to who may fetch it."""

    job_id: str
    state: JobState
    links: EventLinks


class EndpointTestData(WireModel):
    """The endpoint that is tried."""

    webhook_id: str


class WebhookMessage(WireModel):
    """The body of a message."""

    type: str = Field(description="A job event, or `webhook.test`.")
    timestamp: datetime = Field(description="When it happened; not when it is sent.")
    data: JobEventData | EndpointTestData
