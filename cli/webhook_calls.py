"""What may be asked of a server about webhooks."""

from urllib.parse import quote

from cli.connection import Connection
from cli.fitting import fitting
from schemas.webhook import (
    Delivery,
    DeliveryList,
    WebhookList,
    WebhookRequest,
    WebhookWithSecret,
)

_WEBHOOKS = "/v1/webhooks"


class WebhookCalls:
    """The caller's endpoints on one server. Raises as Connection does."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def listed(self) -> WebhookList:
        return fitting(WebhookList, self._connection.call("GET", _WEBHOOKS))

    def add(self, request: WebhookRequest) -> WebhookWithSecret:
        """Register an endpoint. Asked once: twice would be two endpoints."""
        body = request.model_dump(mode="json", exclude_none=True)
        return fitting(WebhookWithSecret, self._connection.once("POST", _WEBHOOKS, json=body))

    def remove(self, webhook_id: str) -> None:
        self._connection.do("DELETE", _address(webhook_id))

    def deliveries(self, webhook_id: str, limit: int) -> DeliveryList:
        address = f"{_address(webhook_id)}/deliveries"
        return fitting(DeliveryList, self._connection.call("GET", address, params={"limit": limit}))

    def replay(self, webhook_id: str, delivery_id: str) -> Delivery:
        """Send a message anew; twice is harmless, since it keeps its id."""
        address = f"{_address(webhook_id)}/deliveries/{quote(delivery_id, safe='')}/replay"
        return fitting(Delivery, self._connection.call("POST", address))


def _address(webhook_id: str) -> str:
    return f"{_WEBHOOKS}/{quote(webhook_id, safe='')}"
