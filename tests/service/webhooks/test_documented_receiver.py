"""The receiver that docs/webhooks.md shows, run as it stands there."""

import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from service.webhooks.signature import new_secret, signed_headers
from tests.service.conftest import Api
from tests.service.webhooks.receiver import Receiver
from tests.service.webhooks.registering import register

DOCUMENT = Path(__file__).parents[3] / "docs" / "webhooks.md"
Answer = Callable[[str, dict[str, str], bytes], int]
OLD, NEW = new_secret(), new_secret()


def code() -> str:
    (block,) = re.findall(r"^```python\n(.*?)^```", DOCUMENT.read_text(), re.M | re.S)
    return str(block)


@pytest.fixture
def handled() -> list[Any]:
    """The messages that were handed on."""
    return []


@pytest.fixture
def answer(handled: list[Any]) -> Answer:
    names: dict[str, Any] = {}
    exec(code(), names)  # noqa: S102 - the document's own code is what is tested
    return lambda *message: int(names["answer"](*message, handled.append))


def headers(body: bytes, *secrets: str, ago_s: int = 0) -> dict[str, str]:
    return signed_headers(secrets, "msg_1", int(time.time()) - ago_s, body)


def test_it_is_short() -> None:
    assert len([line for line in code().splitlines() if line.strip()]) <= 15


def test_a_genuine_message_is_handed_on_once_and_welcome_again(
    answer: Answer, handled: list[Any]
) -> None:
    sent = headers(b'{"a": 1}', OLD)
    assert [answer(OLD, sent, b'{"a": 1}') for _ in range(2)] == [204, 204]
    assert handled == [{"a": 1}]


@pytest.mark.parametrize("secret", [OLD, NEW])
def test_either_secret_verifies_while_they_overlap(answer: Answer, secret: str) -> None:
    assert answer(secret, headers(b"{}", NEW, OLD), b"{}") == 204


@pytest.mark.parametrize("ago_s", [302, 86400, -302])
def test_an_old_or_future_message_is_refused(
    answer: Answer, handled: list[Any], ago_s: int
) -> None:
    assert answer(OLD, headers(b"{}", OLD, ago_s=ago_s), b"{}") == 400
    assert handled == []


def test_a_forged_message_is_refused_and_spoils_no_id(answer: Answer, handled: list[Any]) -> None:
    sent = headers(b"{}", OLD)
    assert answer(OLD, sent, b'{"state": "succeeded"}') == 401
    assert answer(NEW, sent, b"{}") == 401
    stretched = str(int(sent["webhook-timestamp"]) + 1)
    assert answer(OLD, {**sent, "webhook-timestamp": stretched}, b"{}") == 401
    assert answer(OLD, {**sent, "webhook-signature": "v1, v1a,x v2,y"}, b"{}") == 401
    assert handled == []
    assert answer(OLD, sent, b"{}") == 204


def test_it_verifies_what_the_service_sends(
    hooks: Api, receiver: Receiver, answer: Answer, handled: list[Any]
) -> None:
    hook = register(hooks, receiver.url)
    hooks.client.post(f"/v1/webhooks/{hook['id']}/test")
    (message,) = receiver.wait_for(1)
    assert answer(hook["secret"], message.headers, message.body) == 204
    assert handled[0]["type"] == "webhook.test"
