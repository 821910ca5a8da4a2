"""The service under attack: a victim's finished job, an attacker's key, and ways to strike."""

import socket
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx

from benchmarks.fuzzing.running_service import RunningService, running_service
from schemas.api_key import Scope
from service.examples import CONTOUR_REQUEST

SETTINGS: Mapping[str, str] = {
    # Short, so that slow attacks are soon over.
    "NEURALMRI_HEADERS_WITHIN_S": "1",
    "NEURALMRI_BODY_WITHIN_S": "2",
    "NEURALMRI_MAX_LISTENERS_PER_OWNER": "4",
}

SUBJECT = "patient-4711"
"""Whose the victim's job is: to be in no log and in no error."""

_TIMEOUT_S = 30.0


@dataclass(frozen=True)
class Target:
    """victim, attacker: headers with a good key. job: the victim's, at its end."""

    service: RunningService
    victim: Mapping[str, str]
    attacker: Mapping[str, str]
    job: str

    def ask(self, method: str, path: str, **how: Any) -> httpx.Response:
        """One request, as the attacker unless `headers` has a key; paths go out as they are."""
        how["headers"] = {**self.attacker, **how.get("headers", {})}
        with httpx.Client(base_url=self.service.url, timeout=_TIMEOUT_S) as client:
            return client.request(method, path, **how)

    def say(self, *parts: bytes, every_s: float = 0.0, whole: bool = True) -> bytes:
        """Raw bytes over one connection, and all that comes back until it is closed."""
        url = urlsplit(self.service.url)
        with socket.create_connection((url.hostname or "", url.port or 80), _TIMEOUT_S) as peer:
            try:
                for part in parts:
                    peer.sendall(part)
                    time.sleep(every_s)
                if not whole:
                    peer.shutdown(socket.SHUT_WR)
            except OSError:
                pass  # closed already: what it said is still to be read
            return b"".join(_received(peer))

    def raw(self, start: str, *lines: str, body: bytes = b"", key: bool = True) -> bytes:
        """A request head, written by hand."""
        named = ["Host: x", *(f"{k}: {v}" for k, v in self.attacker.items() if key), *lines]
        return ("\r\n".join([start, *named]) + "\r\n\r\n").encode("latin-1") + body

    def is_well(self) -> bool:
        """Whether the service answers others still, and the victim's job is untouched."""
        answer = self.ask("GET", f"/v1/jobs/{self.job}", headers=self.victim)
        return answer.status_code == 200 and answer.json()["state"] == "succeeded"


@dataclass(frozen=True)
class Attack:
    """name: what is tried. expected: the answer, word for word, that `strike` has to bring."""

    name: str
    expected: str
    strike: Callable[[Target], str]


@contextmanager
def target(data_dir: Path) -> Iterator[Target]:
    """A service with a victim's job that has succeeded."""
    with running_service(data_dir, SETTINGS) as service:
        victim = _bearer(service.new_key("victim", Scope.READ, Scope.SUBMIT))
        attacker = _bearer(service.new_key("attacker", Scope.READ, Scope.SUBMIT))
        study = {**CONTOUR_REQUEST["study"], "subject_id": SUBJECT}
        answer = httpx.post(
            f"{service.url}/v1/jobs/contours",
            json={**CONTOUR_REQUEST, "study": study},
            headers={**victim, "Idempotency-Key": "the victim's"},
            timeout=_TIMEOUT_S,
        )
        found = Target(service, victim, attacker, answer.raise_for_status().json()["id"])
        deadline = time.monotonic() + _TIMEOUT_S
        while not found.is_well():
            if time.monotonic() > deadline:
                raise TimeoutError("the victim's job did not end")
            time.sleep(0.05)
        yield found


def told(answer: httpx.Response) -> str:
    """An answer in short: its status, and the type of its problem."""
    if answer.status_code < 400:
        return str(answer.status_code)
    return f"{answer.status_code} {answer.json()['type'].rpartition(':')[2]}"


def told_raw(answer: bytes) -> str:
    """The same of what came over a bare connection; `closed` where that was nothing."""
    if not answer:
        return "closed"
    status = answer.split(b" ", 2)[1].decode()
    kind = answer.partition(b"urn:neuralmri:problem:")[2].partition(b'"')[0].decode()
    return f"{status} {kind}".strip()


def all_of(answers: Iterator[str]) -> str:
    """Different answers, each once."""
    return ", ".join(sorted(set(answers)))


def _bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}


def _received(peer: socket.socket) -> Iterator[bytes]:
    try:
        while part := peer.recv(65536):
            yield part
    except ConnectionResetError:
        return
