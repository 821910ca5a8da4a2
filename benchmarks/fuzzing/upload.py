"""One request as it goes over the wire, byte by byte, and what came back."""

import socket
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from http.client import HTTPException, HTTPResponse
from typing import Any
from urllib.parse import urlsplit


class Framing(StrEnum):
    """How the end of a body is told; some of these lie."""

    LENGTH = "length"
    CHUNKED = "chunked"
    CUT_SHORT = "cut short"
    """More bytes are promised than come, and then the connection is closed for writing."""
    LONGER = "longer than said"
    """More bytes come than were promised; the rest is read as another request."""


@dataclass(frozen=True)
class Upload:
    """A POST. faults: what was done to a good request, for people."""

    path: str
    body: bytes
    headers: Mapping[str, str]
    framing: Framing = Framing.LENGTH
    faults: tuple[str, ...] = field(default=())

    def __repr__(self) -> str:
        size = len(self.body)
        return f"<{self.path}, {size} bytes, {dict(self.headers)}: {', '.join(self.faults)}>"

    def _repr_pretty_(self, printer: Any, _cycle: bool) -> None:
        printer.text(repr(self))  # Hypothesis would print all the bytes


@dataclass(frozen=True)
class Answer:
    """What came back. A status of None: the connection was closed without an answer."""

    status: int | None
    headers: Mapping[str, str]
    body: bytes
    seconds: float


def send(url: str, upload: Upload, headers: Mapping[str, str], within_s: float) -> Answer:
    """POST over a connection of its own. Raises TimeoutError where no answer comes in time."""
    where = urlsplit(url)
    start = time.monotonic()
    with socket.create_connection((where.hostname or "", where.port or 80), within_s) as peer:
        try:
            for part in _parts(upload, {"Host": where.netloc, "Connection": "close", **headers}):
                peer.sendall(part)
            if upload.framing is Framing.CUT_SHORT:
                peer.shutdown(socket.SHUT_WR)
        except OSError:
            pass  # refused before it was all sent: the answer is there all the same
        status, got, body = _received(peer)
    return Answer(status, got, body, time.monotonic() - start)


def _received(peer: socket.socket) -> tuple[int | None, dict[str, str], bytes]:
    try:
        response = HTTPResponse(peer, method="POST")
        response.begin()
        return response.status, {k.lower(): v for k, v in response.getheaders()}, response.read()
    except (ConnectionResetError, HTTPException):
        return None, {}, b""


def _parts(upload: Upload, headers: Mapping[str, str]) -> Iterator[bytes]:
    size = len(upload.body)
    told = {
        Framing.LENGTH: {"Content-Length": str(size)},
        Framing.CHUNKED: {"Transfer-Encoding": "chunked"},
        Framing.CUT_SHORT: {"Content-Length": str(size + 100)},
        Framing.LONGER: {"Content-Length": str(size // 2)},
    }[upload.framing]
    lines = [f"POST {upload.path} HTTP/1.1"]
    lines += [f"{name}: {value}" for name, value in {**headers, **upload.headers, **told}.items()]
    yield ("\r\n".join(lines) + "\r\n\r\n").encode("latin-1")
    if upload.framing is not Framing.CHUNKED:
        yield upload.body
        return
    step = max(1, size // 7)
    for start in range(0, size, step):
        piece = upload.body[start : start + step]
        yield f"{len(piece):x}\r\n".encode() + piece + b"\r\n"
    yield b"0\r\n\r\n"
