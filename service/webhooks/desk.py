"""Endpoints and their messages, as one service process knows them."""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request

from schemas.problem import InputError, ProblemType
from service.settings import ServiceSettings
from service.webhooks.attempt_counts import AttemptCounts
from service.webhooks.endpoint import Endpoint
from service.webhooks.endpoints import Endpoints
from service.webhooks.outbox import Outbox


@dataclass(frozen=True)
class WebhookDesk:
    """What every route about webhooks works with."""

    settings: ServiceSettings
    endpoints: Endpoints
    outbox: Outbox
    attempts: AttemptCounts

    @classmethod
    def of_settings(cls, settings: ServiceSettings) -> "WebhookDesk":
        endpoints = Endpoints(settings.data_dir / "webhooks")
        return cls(settings, endpoints, Outbox(endpoints.root), AttemptCounts())

    def endpoint(self, endpoint_id: str, owner: str) -> Endpoint:
        """The caller's endpoint. Another's is not there. Raises InputError (not found, 404)."""
        endpoint = self.endpoints.get(endpoint_id)
        if endpoint is None or endpoint.owner != owner:
            raise no_such_endpoint()
        return endpoint

    def enabled_endpoint(self, endpoint_id: str, owner: str) -> Endpoint:
        """The same, of one that is sent to. Raises InputError (webhook disabled, 409) too."""
        endpoint = self.endpoint(endpoint_id, owner)
        if endpoint.disabled_at is not None:
            raise InputError(
                ProblemType.WEBHOOK_DISABLED,
                f"the endpoint is disabled: {endpoint.disabled_because}. Remedy: mend it, then "
                f"POST /v1/webhooks/{endpoint_id}/enable.",
                status=409,
            )
        return endpoint


def no_such_endpoint() -> InputError:
    """The answer to an id that names no webhook of the caller's."""
    return InputError(
        ProblemType.NOT_FOUND,
        "there is no such webhook: it never was, or it was removed. Remedy: list yours at "
        "/v1/webhooks.",
        status=404,
    )


def _desk_of(request: Request) -> WebhookDesk:
    desk: WebhookDesk = request.app.state.webhooks
    return desk


Desk = Annotated[WebhookDesk, Depends(_desk_of)]
