"""Registering endpoints over HTTP, and following what was sent to them."""

import time
from typing import Any

from tests.service.conftest import Api


def register(api: Api, url: str, **more: Any) -> dict[str, Any]:
    answer = api.client.post("/v1/webhooks", json={"url": url, **more})
    assert answer.status_code == 201, answer.text
    registered: dict[str, Any] = answer.json()
    assert answer.headers["location"] == f"/v1/webhooks/{registered['id']}"
    return registered


def deliveries(api: Api, webhook_id: str) -> list[dict[str, Any]]:
    answer = api.client.get(f"/v1/webhooks/{webhook_id}/deliveries")
    assert answer.status_code == 200, answer.text
    found: list[dict[str, Any]] = answer.json()["deliveries"]
    return found


def ended_deliveries(api: Api, webhook_id: str, count: int = 1) -> list[dict[str, Any]]:
    """The log, once `count` deliveries are in it and none is pending."""
    deadline = time.monotonic() + 10.0
    while True:
        found = deliveries(api, webhook_id)
        if len(found) >= count and all(d["state"] != "pending" for d in found):
            return found
        assert time.monotonic() < deadline, found
        time.sleep(0.02)
