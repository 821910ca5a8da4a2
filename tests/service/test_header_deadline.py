"""Connections that do not say what they want, over the protocol that production uses."""

import socket
import threading
import time
from collections.abc import Iterator

import httpx
import pytest
import uvicorn

from service.app import create_app
from service.header_deadline import HeaderDeadline
from service.settings import ServiceSettings
from tests.redis_server import free_port

WITHIN_S = 0.5
REQUEST = b"GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n"


@pytest.fixture
def port(settings: ServiceSettings) -> Iterator[int]:
    app = create_app(settings.model_copy(update={"headers_within_s": WITHIN_S}))
    config = uvicorn.Config(
        app, host="127.0.0.1", port=free_port(), log_level="error", http=HeaderDeadline
    )
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        assert thread.is_alive()
        time.sleep(0.01)
    yield config.port
    server.should_exit = True
    thread.join(timeout=20.0)


def closed(connection: socket.socket) -> bool:
    """The other side ends the connection; a TimeoutError where it does not."""
    try:
        while connection.recv(4096):
            pass
    except ConnectionResetError:
        pass
    return True


def drip(connection: socket.socket) -> None:
    """A header's value that goes on and on."""
    for _ in range(200):
        connection.sendall(b"y")
        time.sleep(0.05)


@pytest.mark.parametrize("said", [b"", b"G", REQUEST[:-2]], ids=["nothing", "a byte", "no end"])
def test_a_connection_without_whole_headers_is_given_up(port: int, said: bytes) -> None:
    with socket.create_connection(("127.0.0.1", port), timeout=10.0) as connection:
        connection.sendall(said)
        assert closed(connection)


def test_a_byte_now_and_then_does_not_keep_it_open(port: int) -> None:
    with socket.create_connection(("127.0.0.1", port), timeout=10.0) as connection:
        connection.sendall(REQUEST[:-2])
        with pytest.raises(OSError, match=r"reset|[Bb]roken pipe"):
            drip(connection)


def test_a_later_request_on_the_connection_is_held_to_it_too(port: int) -> None:
    with socket.create_connection(("127.0.0.1", port), timeout=10.0) as connection:
        connection.sendall(REQUEST)
        assert connection.recv(4096).startswith(b"HTTP/1.1 200")
        connection.sendall(REQUEST[:10])
        assert closed(connection)


def test_what_takes_long_after_its_headers_is_left_alone(port: int) -> None:
    with socket.create_connection(("127.0.0.1", port), timeout=10.0) as connection:
        body = b'{"study": 1}'
        connection.sendall(
            b"POST /v1/validate/contours HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
            b"Content-Length: %d\r\n\r\n" % len(body)
        )
        time.sleep(2 * WITHIN_S)
        connection.sendall(body)
        assert connection.recv(4096).startswith(b"HTTP/1.1 422")


def test_a_connection_that_is_kept_serves_on(port: int) -> None:
    with httpx.Client(base_url=f"http://127.0.0.1:{port}") as client:
        for _ in range(3):
            assert client.get("/healthz").is_success
            time.sleep(0.4 * WITHIN_S)
