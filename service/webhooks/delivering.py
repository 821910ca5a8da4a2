"""One attempt at one message: sign, send, and write down what became of it."""

import asyncio
import logging
import random
import time
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial

import httpx

from jobs import spans
from jobs.spans import Span, SpanKind
from jobs.trace_context import TraceContext
from schemas.webhook import DeliveryAttempt
from service.webhooks.attempt_counts import AttemptCounts
from service.webhooks.endpoint import Endpoint
from service.webhooks.endpoints import Endpoints
from service.webhooks.message import Message
from service.webhooks.outbox import Outbox
from service.webhooks.retry import retry_after_s
from service.webhooks.sending import Answer, Sender
from service.webhooks.settings import WebhookSettings
from service.webhooks.signature import signed_headers
from service.webhooks.target import TargetRefused

_GONE = 410

_LOGGER = logging.getLogger("neuralmri.webhooks")


@dataclass(frozen=True)
class Postman:
    """Delivers messages of an outbox, one at a time."""

    settings: WebhookSettings
    endpoints: Endpoints
    outbox: Outbox
    sender: Sender
    attempts: AttemptCounts

    async def deliver(self, endpoint_id: str, message_id: str) -> None:
        """Try once. Where what came of it cannot be noted, it is tried again, under the same id."""
        now = datetime.now(UTC)
        endpoint = await asyncio.to_thread(self.endpoints.get, endpoint_id)
        message = await asyncio.to_thread(self.outbox.get, endpoint_id, message_id)
        if endpoint is None or message is None or not message.is_due(now):
            return
        attempt, answer = await self._attempt(endpoint, message, now)
        await asyncio.to_thread(self._record, endpoint_id, message_id, attempt, answer)

    async def _attempt(
        self, endpoint: Endpoint, message: Message, now: datetime
    ) -> tuple[DeliveryAttempt, Answer | None]:
        body = message.body.encode()
        headers = signed_headers(endpoint.live_secrets(now), message.id, int(now.timestamp()), body)
        start_s = time.monotonic()
        answer, error = None, None
        try:
            answer = await self.sender.post(endpoint.url, body, headers)
        except TargetRefused as refused:
            error = f"not sent, the address is refused: {refused}"
        except (TimeoutError, httpx.TimeoutException):
            error = f"no whole answer within {self.settings.webhook_timeout_s:g} s"
        except httpx.TransportError as trouble:
            error = f"no connection or no answer: {type(trouble).__name__}"
        if answer is not None and not 200 <= answer.status < 300:
            error = f"the answer was {answer.status}, not 2xx; redirects are not followed"
        attempt = DeliveryAttempt(
            at=now,
            duration_s=round(time.monotonic() - start_s, 3),
            status=answer.status if answer else None,
            answer=answer.body.decode("utf-8", "replace") if answer else None,
            error=error,
        )
        _record_span(message, attempt)
        return attempt, answer

    def _record(
        self, endpoint_id: str, message_id: str, attempt: DeliveryAttempt, answer: Answer | None
    ) -> None:
        now = datetime.now(UTC)
        put_off_s = retry_after_s(answer.retry_after if answer else None, now)
        message = self.outbox.change(
            endpoint_id, message_id, partial(self._message_after, attempt, now, put_off_s)
        )
        if message is not None:
            self.attempts.note(message)
        endpoint = self.endpoints.change(endpoint_id, partial(self._endpoint_after, attempt, now))
        if attempt.error:
            _LOGGER.info("message %s to %s: %s", message_id, endpoint_id, attempt.error)
        if endpoint is not None and endpoint.disabled_at == now:
            _LOGGER.warning("endpoint %s is disabled: %s", endpoint_id, endpoint.disabled_because)

    def _message_after(
        self, attempt: DeliveryAttempt, now: datetime, put_off_s: float, message: Message
    ) -> Message:
        if attempt.error is None:
            return message.delivered(attempt)
        if attempt.status == _GONE:
            return message.given_up(attempt)
        return message.failed(
            attempt,
            self.settings.webhook_delays_s,
            now,
            put_off_s=put_off_s,
            draw=random.random(),  # noqa: S311 - it spreads retries and guards nothing
        )

    def _endpoint_after(
        self, attempt: DeliveryAttempt, now: datetime, endpoint: Endpoint
    ) -> Endpoint:
        if attempt.error is None:
            return endpoint.answered()
        if attempt.status == _GONE:
            return endpoint.disabled(now, "it answered 410 Gone")
        return endpoint.failed(now, self.settings.webhook_disable_after_s)


def _record_span(message: Message, attempt: DeliveryAttempt) -> None:
    """The attempt as part of the job's trace. Its URL is not said: it may hold a secret."""
    request = TraceContext.parsed(message.traceparent)
    if request is None:
        return
    attributes: dict[str, str | int] = {"neuralmri.webhook.message": message.id}
    if message.job_id is not None:
        attributes["neuralmri.job.id"] = message.job_id
    if attempt.status is not None:
        attributes["http.response.status_code"] = attempt.status
    begun_s = attempt.at.timestamp()
    spans.record(
        Span(
            "webhook delivery",
            request.child(),
            request.span_id,
            begun_s,
            begun_s + attempt.duration_s,
            SpanKind.CLIENT,
            attributes,
            failed=attempt.error is not None,
        )
    )
