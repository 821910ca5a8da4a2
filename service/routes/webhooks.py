"""Webhooks: register endpoints, look at them, rotate their secrets, remove them."""

from collections.abc import Callable
from datetime import UTC, datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response

from intake.json_body import parse_json
from schemas.problem import InputError, ProblemType
from schemas.webhook import Webhook, WebhookList, WebhookRequest, WebhookWithSecret
from service.access import Access, Owner
from service.documented import problems
from service.media_type import require_media_type
from service.webhooks.desk import Desk, WebhookDesk, no_such_endpoint
from service.webhooks.endpoint import Endpoint
from service.webhooks.endpoints import TooManyEndpoints
from service.webhooks.target import (
    TargetRefused,
    checked_url,
    permitted_addresses,
    system_addresses,
)

router = APIRouter(tags=["webhooks"])

_JSON = "application/json"
_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            _JSON: {
                "schema": {"$ref": "#/components/schemas/WebhookRequest"},
                "example": {
                    "url": "https://hooks.example.org/neuralmri",
                    "events": ["job.succeeded", "job.failed"],
                },
            }
        },
    }
}


async def _body(request: Request) -> bytes:
    require_media_type(request, _JSON)
    return await request.body()


@router.post(
    "/v1/webhooks",
    status_code=201,
    responses={
        201: {
            "description": "Registered. The secret is not shown again.",
            "headers": {"Location": {"schema": {"type": "string"}}},
        },
        **problems(400, 413, 415, 422, 507),
    },
    openapi_extra=_BODY,
)
def register_webhook(
    body: Annotated[bytes, Depends(_body)],
    desk: Desk,
    access: Access,
    owner: Owner,
    response: Response,
) -> WebhookWithSecret:
    """Have an endpoint of yours told when your jobs end.

    Messages are signed by Standard Webhooks with the secret in the answer.
    """
    settings = desk.settings
    request = parse_json(body, WebhookRequest, settings.limits())
    _check_target(request.url, desk)
    endpoint = Endpoint.of_request(request, owner, access.records.now())
    try:
        desk.endpoints.add(endpoint, settings.webhook_max_endpoints)
    except TooManyEndpoints as error:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"you have {settings.webhook_max_endpoints} webhooks, which is as many as there may "
            "be. Remedy: remove one that is no longer needed.",
        ) from error
    response.headers["Location"] = f"/v1/webhooks/{endpoint.id}"
    return endpoint.with_secret()


@router.get("/v1/webhooks", responses=problems())
def list_webhooks(desk: Desk, owner: Owner) -> WebhookList:
    """Your endpoints, oldest first, without their secrets."""
    return WebhookList(webhooks=[e.public() for e in desk.endpoints.of_owner(owner)])


@router.get("/v1/webhooks/{webhook_id}", responses=problems(404))
def get_webhook(webhook_id: str, desk: Desk, owner: Owner) -> Webhook:
    """One endpoint, without its secret."""
    return desk.endpoint(webhook_id, owner).public()


@router.delete(
    "/v1/webhooks/{webhook_id}", status_code=204, response_class=Response, responses=problems(404)
)
def remove_webhook(webhook_id: str, desk: Desk, owner: Owner) -> None:
    """Forget the endpoint and its deliveries, those that wait included."""
    desk.endpoints.remove(desk.endpoint(webhook_id, owner).id)


@router.post("/v1/webhooks/{webhook_id}/rotate", responses=problems(404, 507))
def rotate_webhook_secret(webhook_id: str, desk: Desk, owner: Owner) -> WebhookWithSecret:
    """Give the endpoint a new secret, shown this once.

    For a day, or as long as the operator says, messages carry a signature by the old one too.
    """
    overlap_s = desk.settings.webhook_overlap_s
    now = datetime.now(UTC)
    return _changed(webhook_id, desk, owner, lambda e: e.rotated(now, overlap_s)).with_secret()


@router.post("/v1/webhooks/{webhook_id}/enable", responses=problems(404, 422, 507))
def enable_webhook(webhook_id: str, desk: Desk, owner: Owner) -> Webhook:
    """Send again to an endpoint that was disabled; what waits is sent at once.

    Jobs that ended meanwhile are not announced: list your jobs to find them.
    """
    _check_target(desk.endpoint(webhook_id, owner).url, desk)
    return _changed(webhook_id, desk, owner, Endpoint.enabled).public()


def _changed(
    webhook_id: str, desk: WebhookDesk, owner: str, step: Callable[[Endpoint], Endpoint]
) -> Endpoint:
    changed = desk.endpoints.change(desk.endpoint(webhook_id, owner).id, step)
    if changed is None:
        raise no_such_endpoint()
    return changed


def _check_target(text: str, desk: WebhookDesk) -> None:
    """Raises InputError (webhook target refused, 422) for a URL that is not to be sent to."""
    rules = desk.settings.webhook_targets
    try:
        permitted_addresses(checked_url(text, rules), rules, system_addresses)
    except TargetRefused as error:
        raise InputError(
            ProblemType.WEBHOOK_TARGET_REFUSED,
            f"the URL is not to be sent to: {error}",
            pointer="/url",
        ) from error
