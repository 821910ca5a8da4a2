"""What was sent to an endpoint, and sending it anew."""

from datetime import UTC, datetime
from typing import Annotated

from fastapi import APIRouter, Query

from schemas.problem import InputError, ProblemType
from schemas.webhook import Delivery, DeliveryList
from service.access import Owner
from service.documented import problems
from service.webhooks.desk import Desk, no_such_endpoint
from service.webhooks.message import Message

router = APIRouter(tags=["webhooks"])


@router.post("/v1/webhooks/{webhook_id}/test", status_code=202, responses=problems(404, 409, 507))
def test_webhook(webhook_id: str, desk: Desk, owner: Owner) -> Delivery:
    """Send a `webhook.test` message to the endpoint, whatever events it is registered for."""
    endpoint = desk.enabled_endpoint(webhook_id, owner)
    message = Message.of_test(endpoint.id, datetime.now(UTC))
    if not desk.outbox.add(endpoint.id, message):
        raise no_such_endpoint()
    return message.public()


@router.get("/v1/webhooks/{webhook_id}/deliveries", responses=problems(404, 422))
def list_webhook_deliveries(
    webhook_id: str,
    desk: Desk,
    owner: Owner,
    limit: Annotated[int, Query(ge=1, le=200)] = 50,
) -> DeliveryList:
    """The endpoint's messages, newest first: those that wait, and the last that ended."""
    endpoint = desk.endpoint(webhook_id, owner)
    found = desk.outbox.newest(endpoint.id, limit)
    return DeliveryList(deliveries=[message.public() for message in found])


@router.post(
    "/v1/webhooks/{webhook_id}/deliveries/{delivery_id}/replay",
    status_code=202,
    responses=problems(404, 409, 507),
)
def replay_webhook_delivery(
    webhook_id: str, delivery_id: str, desk: Desk, owner: Owner
) -> Delivery:
    """Send a message now, whether it was delivered or not, and again by the schedule if it fails.

    It keeps its `webhook-id`; a receiver that has it may drop it.
    """
    endpoint = desk.enabled_endpoint(webhook_id, owner)
    now = datetime.now(UTC)
    message = desk.outbox.change(endpoint.id, delivery_id, lambda m: m.replayed(now))
    if message is None:
        raise InputError(
            ProblemType.NOT_FOUND,
            "the webhook has no such delivery: it never was, or it is too long ago. Remedy: list "
            "them at its `deliveries`.",
            status=404,
        )
    return message.public()
