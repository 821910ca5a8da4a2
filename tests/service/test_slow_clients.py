"""Callers who send their body byte by byte, or walk away in the middle of it."""

import logging
import socket
import time
from collections.abc import Callable, Iterator

import pytest

from service.settings import ServiceSettings
from tests.service.conftest import Api

HEAD = (
    b"POST /v1/jobs/contours HTTP/1.1\r\nHost: x\r\n"
    b"Content-Type: application/json\r\nContent-Length: 1000\r\n\r\n{"
)


@pytest.fixture
def hasty_api(settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]) -> Api:
    return serve(settings.model_copy(update={"body_within_s": 0.5}))


@pytest.fixture
def connection(hasty_api: Api) -> Iterator[socket.socket]:
    url = hasty_api.client.base_url
    with socket.create_connection((url.host, url.port), timeout=10.0) as connected:
        yield connected


def test_a_body_that_takes_too_long_is_given_up(connection: socket.socket, hasty_api: Api) -> None:
    connection.sendall(HEAD)
    answer = b""
    start = time.monotonic()
    while part := connection.recv(4096):
        answer += part
    assert time.monotonic() - start < 5.0, "the connection is closed, not only answered"
    assert answer.startswith(b"HTTP/1.1 408")
    assert b"application/problem+json" in answer
    assert b"Remedy" in answer
    assert list(hasty_api.store.root.iterdir()) == []


def test_who_walks_away_leaves_nothing_and_no_traceback(
    connection: socket.socket, hasty_api: Api, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        connection.sendall(HEAD)
        time.sleep(0.1)
        connection.close()
        deadline = time.monotonic() + 5.0
        counted = 'route="/v1/jobs/contours",status="400"'
        while counted not in hasty_api.client.get("/metrics").text:
            assert time.monotonic() < deadline
            time.sleep(0.05)
    assert caplog.records == []
    assert list(hasty_api.store.root.iterdir()) == []
