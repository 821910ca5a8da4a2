"""Using the service up: bombs, bodies and headers without end, slowness, many connections."""

import gzip
import json
import socket
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from urllib.parse import urlsplit

import httpx

from benchmarks.attacks.target import Attack, Target, all_of, told, told_raw
from benchmarks.fuzzing.judging import MEMORY_CAP_BYTES
from benchmarks.fuzzing.label_uploads import bomb
from benchmarks.fuzzing.seeds import LABEL_REQUEST, label_maps
from service.examples import CONTOUR_REQUEST

_MIB = 1 << 20
_CONTOURS = "POST /v1/jobs/contours HTTP/1.1"
_JSON = "Content-Type: application/json"


def _labels(target: Target, sax: bytes) -> str:
    answer = target.ask(
        "POST",
        "/v1/jobs/labels",
        files={
            "request": (None, json.dumps(LABEL_REQUEST).encode(), "application/json"),
            "sax": ("sax.nii.gz", sax, "application/octet-stream"),
        },
    )
    return told(answer)


def _bomb(target: Target) -> str:
    said = _labels(target, bomb(label_maps()["sax"]))
    small = target.service.peak_memory_bytes() < MEMORY_CAP_BYTES
    return f"{said}; {'below' if small else 'above'} 1 GiB"


def _huge_dims(target: Target) -> str:
    head = bytearray(label_maps()["sax"])
    for axis in (1, 2, 3):
        head[40 + 2 * axis : 42 + 2 * axis] = (32767).to_bytes(2, "little")
    return _labels(target, gzip.compress(bytes(head)))


def _larger_dims(target: Target) -> str:
    head = bytearray(label_maps()["sax"])
    head[42:44] = (500).to_bytes(2, "little")
    return _labels(target, gzip.compress(bytes(head)))


def _encoded(target: Target) -> str:
    body = gzip.compress(bytes(50 * _MIB))
    answers = (
        told(
            target.ask(
                "POST",
                path,
                content=body,
                headers={"Content-Type": "application/json", "Content-Encoding": "gzip"},
            )
        )
        for path in ("/v1/jobs/contours", "/v1/validate/contours", "/v1/webhooks")
    )
    return all_of(answers)


def _declared(target: Target) -> str:
    head = target.raw(_CONTOURS, _JSON, f"Content-Length: {10**15}", body=b"{")
    return told_raw(target.say(head))


def _chunked(target: Target) -> str:
    head = target.raw(_CONTOURS, _JSON, "Transfer-Encoding: chunked")
    chunk = f"{_MIB:x}\r\n".encode() + b" " * _MIB + b"\r\n"
    return told_raw(target.say(head, *[chunk] * 40))


def _large_header(target: Target) -> str:
    return told_raw(target.say(target.raw("GET /v1/jobs HTTP/1.1", "X: " + "y" * 200_000)))


def _many_headers(target: Target) -> str:
    return told_raw(target.say(target.raw("GET /v1/jobs HTTP/1.1", *["X: y"] * 50_000)))


def _slow_headers(target: Target) -> str:
    head = target.raw("GET /v1/jobs HTTP/1.1", "X: " + "y" * 30)
    return told_raw(target.say(*(bytes([b]) for b in head), every_s=0.05))


def _silent(target: Target) -> str:
    start = time.monotonic()
    said = told_raw(target.say())
    return f"{said} {'in time' if time.monotonic() - start < 20.0 else 'late'}"


def _slow_body(target: Target) -> str:
    head = target.raw(_CONTOURS, _JSON, "Content-Length: 100000")
    return told_raw(target.say(head, *[b" "] * 40, every_s=0.1))


def _connections(target: Target) -> str:
    """Hundreds of connections that say nothing; meanwhile others are served, and then they end."""
    url = urlsplit(target.service.url)
    with ExitStack() as stack:
        peers = [
            stack.enter_context(socket.create_connection((url.hostname or "", url.port or 80), 30))
            for _ in range(300)
        ]
        served = target.is_well()
        ended = all(_is_closed(peer) for peer in peers)
    return f"{'others served' if served else 'others not served'}; {'closed' if ended else 'kept'}"


def _is_closed(peer: socket.socket) -> bool:
    try:
        return not peer.recv(1)
    except ConnectionResetError:
        return True


def _streams(target: Target) -> str:
    """One more event stream than a key's owner may have open; then the victim opens one."""
    with ExitStack() as stack:
        stack.enter_context(target.service.engine.paused())
        client = stack.enter_context(httpx.Client(base_url=target.service.url, timeout=30.0))

        def open_stream(key: Mapping[str, str], job: str) -> int:
            path = f"/v1/jobs/{job}/events"
            return stack.enter_context(client.stream("GET", path, headers=dict(key))).status_code

        jobs = {
            name: client.post("/v1/jobs/contours", json=CONTOUR_REQUEST, headers=dict(key))
            for name, key in (("own", target.attacker), ("other", target.victim))
        }
        own = [open_stream(target.attacker, jobs["own"].json()["id"]) for _ in range(5)]
        other = open_stream(target.victim, jobs["other"].json()["id"])
        return f"{own[-1]} to the fifth; {other} to others"


def _deep(target: Target) -> str:
    def bodies() -> Iterator[bytes]:
        yield b"[" * 1_000_000
        yield b'{"a":' * 200_000
        yield b"[" * 500_000 + b"]" * 500_000
        yield b"[" + b"1," * 3_000_000 + b"1]"

    return all_of(_json(target, body) for body in bodies())


def _patterns(target: Target) -> str:
    """Strings on which patterns that go back would take for ever."""
    start = time.monotonic()
    long = "a" * 100_000
    answers = [
        target.ask("GET", "/v1/jobs", params={"cursor": "0" * 30_000}),
        target.ask("GET", "/v1/jobs", headers={"Prefer": 'wait="' + '\\"' * 15_000}),
        target.ask("GET", f"/v1/jobs/{target.job}/artifacts/{'a' * 30_000}!"),
        target.ask("GET", "/v1/jobs", headers={"traceparent": "00-" + "0" * 30_000}),
    ]
    _json(target, b'{"' + b"\\" * 2_000_000)
    _json(target, json.dumps({"study": {"subject_id": long + "!"}}).encode())
    quick = time.monotonic() - start < 30.0
    return (
        f"{max(a.status_code for a in answers) < 500 and 'no 5xx'}; {'quick' if quick else 'slow'}"
    )


def _json(target: Target, body: bytes) -> str:
    headers = {"Content-Type": "application/json"}
    return told(target.ask("POST", "/v1/jobs/contours", content=body, headers=headers))


ATTACKS = (
    Attack("a gzip bomb: 300 MiB of zeros in 300 kB", "413 too-large; below 1 GiB", _bomb),
    Attack(
        "a gzip in a gzip",
        "422 unreadable-label-map",
        lambda t: _labels(t, gzip.compress(gzip.compress(label_maps()["sax"]))),
    ),
    Attack("a NIfTI header of 32767³ voxels", "413 too-large", _huge_dims),
    Attack("NIfTI dimensions larger than the data", "422 unreadable-label-map", _larger_dims),
    Attack("`Content-Encoding: gzip` around 50 MiB", "415 unsupported-media-type", _encoded),
    Attack("a `Content-Length` of 10¹⁵", "413 too-large", _declared),
    Attack("a chunked body of 40 MiB", "413 too-large", _chunked),
    Attack("JSON a million deep, or of three million values", "413 too-large", _deep),
    Attack("strings made for patterns that go back (ReDoS)", "no 5xx; quick", _patterns),
    Attack("a header of 200 kB", "400", _large_header),
    Attack("50 000 headers", "400", _many_headers),
    Attack("headers a byte at a time (Slowloris)", "closed", _slow_headers),
    Attack("a connection that says nothing", "closed in time", _silent),
    Attack("a body a byte at a time (slow POST)", "408 invalid-request", _slow_body),
    Attack("300 connections that say nothing", "others served; closed", _connections),
    Attack(
        "more event streams than an owner may have (here 4)",
        "429 to the fifth; 200 to others",
        _streams,
    ),
)
