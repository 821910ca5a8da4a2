"""An endpoint as it is stored, and the steps of its life."""

import secrets
from collections.abc import Sequence
from datetime import datetime, timedelta

from pydantic import Field

from schemas.base import WireModel
from schemas.webhook import JobEvent, Webhook, WebhookRequest, WebhookWithSecret
from service.webhooks.signature import new_secret

ENDPOINT_ID_PATTERN = r"^ep_[0-9a-f]{24}$"

_MOST_SECRETS = 4
"""A rotation a minute must not make the signatures outgrow what servers take for headers."""


class SigningSecret(WireModel):
    """A secret and when it stops signing; the newest has no such time."""

    secret: str
    until: datetime | None = None


class Endpoint(Webhook):
    """`endpoint.json`: what its owner sees, and what nobody sees.

    failing_since: the first failure after the last success, None after a success.
    """

    owner: str
    secrets: list[SigningSecret] = Field(min_length=1)
    failing_since: datetime | None = None

    @classmethod
    def of_request(cls, request: WebhookRequest, owner: str, now: datetime) -> "Endpoint":
        return cls(
            id=f"ep_{secrets.token_hex(12)}",
            url=request.url,
            events=sorted(set(request.events)),
            label=request.label,
            created_at=now,
            owner=owner,
            secrets=[SigningSecret(secret=new_secret())],
        )

    def public(self) -> Webhook:
        return Webhook(**{name: getattr(self, name) for name in Webhook.model_fields})

    def with_secret(self) -> WebhookWithSecret:
        return WebhookWithSecret(**dict(self.public()), secret=self.secrets[0].secret)

    def live_secrets(self, now: datetime) -> Sequence[str]:
        """What to sign with, the newest first."""
        return [s.secret for s in self.secrets if s.until is None or s.until > now]

    def wants(self, event: JobEvent) -> bool:
        return self.disabled_at is None and event in self.events

    def rotated(self, now: datetime, overlap_s: float) -> "Endpoint":
        """With a new secret; the one before signs beside it for `overlap_s`."""
        newest, *older = self.secrets
        until = now + timedelta(seconds=overlap_s)
        kept = [newest.model_copy(update={"until": until}), *older]
        live = [s for s in kept if s.until is not None and s.until > now]
        new = SigningSecret(secret=new_secret())
        return self.model_copy(update={"secrets": [new, *live][:_MOST_SECRETS]})

    def answered(self) -> "Endpoint":
        """After a success."""
        return self.model_copy(update={"failing_since": None})

    def failed(self, now: datetime, disable_after_s: float) -> "Endpoint":
        """After a failure: disabled, where there was nothing but failures for so long."""
        since = self.failing_since or now
        failing = self.model_copy(update={"failing_since": since})
        if (now - since).total_seconds() < disable_after_s:
            return failing
        return failing.disabled(now, f"every attempt since {since:%Y-%m-%d %H:%M} UTC has failed")

    def disabled(self, now: datetime, because: str) -> "Endpoint":
        if self.disabled_at is not None:
            return self
        return self.model_copy(update={"disabled_at": now, "disabled_because": because})

    def enabled(self) -> "Endpoint":
        return self.model_copy(
            update={"disabled_at": None, "disabled_because": None, "failing_since": None}
        )
