"""Where a connection really goes, under which name, and when it is given up."""

import asyncio
import shutil
import socket
import ssl
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from ipaddress import ip_network
from pathlib import Path

import httpx
import pytest

from service.webhooks import sending
from service.webhooks.sending import Answer, Sender
from service.webhooks.target import Resolve, TargetRefused
from service.webhooks.target_rules import TargetRules
from tests.redis_server import free_port
from tests.service.webhooks.receiver import Receiver, Reply

LOOPBACK = TargetRules(http=True, high_ports=True, allow=(ip_network("127.0.0.0/8"),))
Send = Callable[..., Answer]


def to(*addresses: str) -> Resolve:
    return lambda _host, _port: list(addresses)


HERE = to("127.0.0.1")


@pytest.fixture
def send() -> Iterator[Send]:
    with ThreadPoolExecutor(2) as resolvers:

        def post(
            url: str,
            resolve: Resolve = HERE,
            rules: TargetRules = LOOPBACK,
            timeout_s: float = 5.0,
            trust: ssl.SSLContext | None = None,
        ) -> Answer:
            context = trust or ssl.create_default_context()
            sender = Sender(rules, timeout_s, resolve, context, resolvers)
            return asyncio.run(sender.post(url, b"{}", {"webhook-id": "msg_1"}))

        yield post


def test_the_body_goes_to_the_resolved_address_under_the_urls_name(
    send: Send, receiver: Receiver
) -> None:
    url = f"http://hooks.example.org:{receiver.port}/a/b?c=d"
    assert send(url).status == 204
    (received,) = receiver.received
    assert received.path == "/a/b?c=d"
    assert received.headers["host"] == f"hooks.example.org:{receiver.port}"
    assert received.headers["content-type"] == "application/json"
    assert received.headers["webhook-id"] == "msg_1"
    assert received.body == b"{}"


def test_a_name_is_asked_once_and_a_changed_answer_is_refused(
    send: Send, receiver: Receiver
) -> None:
    """DNS rebinding: the first answer is permitted, all later ones lead inside."""
    asked: list[str] = []

    def rebinding(host: str, _port: int) -> list[str]:
        asked.append(host)
        return ["127.0.0.1"] if len(asked) == 1 else ["169.254.169.254"]

    url = f"http://hooks.example.org:{receiver.port}/"
    assert send(url, rebinding).status == 204
    assert asked == ["hooks.example.org"]
    with pytest.raises(TargetRefused):
        send(url, rebinding)
    assert len(receiver.received) == 1


def test_a_redirect_is_an_answer_and_is_not_followed(send: Send, receiver: Receiver) -> None:
    receiver.otherwise = Reply(307, {"Location": receiver.url})
    assert send(receiver.url).status == 307
    assert len(receiver.received) == 1


def test_a_proxy_of_the_environment_is_not_used(
    send: Send, receiver: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "http_proxy"):
        monkeypatch.setenv(name, f"http://127.0.0.1:{free_port()}")
    assert send(receiver.url).status == 204


def test_the_next_address_is_tried_where_one_takes_no_connection(
    send: Send, receiver: Receiver
) -> None:
    assert send(receiver.url, to("127.0.0.2", "127.0.0.1")).status == 204
    with pytest.raises(httpx.ConnectError):
        send(receiver.url, to("127.0.0.2", "127.0.0.3"))


def test_little_of_a_long_answer_is_read(send: Send, receiver: Receiver) -> None:
    receiver.otherwise = Reply(200, {"Retry-After": "7"}, b"0123456789" * 1_000_000)
    answer = send(receiver.url)
    assert answer == Answer(200, b"0123456789" * 20, "7")


def test_a_receiver_that_drips_is_given_up_in_time(send: Send) -> None:
    """Each byte comes soon; the whole never does."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def drip() -> None:
            connection, _ = server.accept()
            with connection:
                try:
                    connection.sendall(b"HTTP/1.1 200 OK\r\nX-Endless: ")
                    while True:
                        connection.sendall(b"x")
                        time.sleep(0.05)
                except OSError:
                    return

        thread = threading.Thread(target=drip)
        thread.start()
        start = time.monotonic()
        with pytest.raises(TimeoutError):
            send(f"http://hooks.example.org:{server.getsockname()[1]}/", timeout_s=0.5)
        assert time.monotonic() - start < 1.5
        thread.join()


def test_a_slow_name_server_counts_as_time(send: Send, receiver: Receiver) -> None:
    def slow(_host: str, _port: int) -> list[str]:
        time.sleep(0.6)
        return ["127.0.0.1"]

    with pytest.raises(TimeoutError):
        send(receiver.url, slow, timeout_s=0.2)
    assert receiver.received == []


@contextmanager
def tls_server(folder: Path, host: str) -> Iterator[tuple[int, ssl.SSLContext, list[str | None]]]:
    """A port that answers 204 over TLS with a certificate for `host`, who trusts it, and the names
    that clients asked for.
    """
    key, certificate = folder / "key.pem", folder / "certificate.pem"
    subprocess.run(
        [
            *("openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256"),
            *("-nodes", "-days", "2", "-subj", f"/CN={host}"),
            *("-addext", f"subjectAltName=DNS:{host}"),
            *("-addext", "basicConstraints=critical,CA:TRUE"),
            *("-keyout", str(key), "-out", str(certificate)),
        ],
        check=True,
        capture_output=True,
    )
    asked: list[str | None] = []
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    context.sni_callback = lambda _socket, name, _context: asked.append(name)
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer() -> None:
            while True:
                try:
                    connection, _ = server.accept()
                except OSError:
                    return
                with connection:
                    try:
                        with context.wrap_socket(connection, server_side=True) as secured:
                            request = b""  # all of it: see below
                            while not request.endswith(b"\r\n\r\n{}"):
                                request += secured.recv(65536) or b"\r\n\r\n{}"
                            secured.sendall(b"HTTP/1.1 204 No Content\r\n\r\n")
                            # Closed while something is unread, or before the client is done, the
                            # connection would be reset, and the answer lost with it.
                            while secured.recv(65536):
                                pass
                    except OSError:
                        continue  # the client did not like the certificate

        thread = threading.Thread(target=answer)
        thread.start()
        yield server.getsockname()[1], ssl.create_default_context(cafile=str(certificate)), asked
        server.shutdown(socket.SHUT_RDWR)
    thread.join()


@pytest.mark.skipif(shutil.which("openssl") is None, reason="no openssl to make a certificate")
def test_certificate_and_server_name_are_the_urls_and_not_the_addresses(
    send: Send, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sending, "_CONNECT_WITHIN_S", 60.0)  # a handshake is part of it
    with tls_server(tmp_path, "hooks.example.org") as (port, trust, asked):

        def post(host: str, trust: ssl.SSLContext | None) -> Answer:
            return send(f"https://{host}:{port}/", trust=trust, timeout_s=60.0)

        assert post("hooks.example.org", trust).status == 204
        with pytest.raises(httpx.ConnectError, match="certificate"):
            post("other.example.org", trust)
        with pytest.raises(httpx.ConnectError, match="certificate"):
            post("hooks.example.org", None)
    assert asked == ["hooks.example.org", "other.example.org", "hooks.example.org"]
