"""A client as it should be: every submission under a key of its own, sent until it is accepted."""

import random
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import httpx

_PATIENCE_S = 180.0
_ALLOWED = (409, 503)
"""Said to be passing by the API's description: the key's first request is under way, or Redis is
away. Whatever else is said is a fault."""


@dataclass
class Submission:
    """One job to be, and what was said about it.

    job_ids: of every answer of 202, replays among them. unanswered: requests whose connection
    broke, or whose answer the client did not wait for. statuses: of other answers.
    """

    key: str
    body: dict[str, Any]
    job_ids: list[str] = field(default_factory=list)
    unanswered: int = 0
    statuses: list[int] = field(default_factory=list)

    @property
    def faults(self) -> list[str]:
        """What the client may complain of."""
        told = [f"{self.key}: answered {s}" for s in self.statuses if s not in _ALLOWED]
        if not self.job_ids:
            told.append(f"{self.key}: never accepted")
        if len(set(self.job_ids)) > 1:
            told.append(f"{self.key}: was given {len(set(self.job_ids))} jobs")
        return told


class Client:
    """Sends from any thread. Some answers it does not wait for, as one whose line breaks."""

    def __init__(self, url: str, seed: int, impatience: float) -> None:
        """impatience: the share of requests that are given up after milliseconds."""
        self._url = url
        self._draw = random.Random(seed)
        self._lock = threading.Lock()
        self._impatience = impatience

    def submit(self, submission: Submission) -> None:
        """Send until there is a 202, or for three minutes."""
        deadline = time.monotonic() + _PATIENCE_S
        answered = False
        while not answered and time.monotonic() < deadline:
            with self._lock:
                gives_up = self._draw.random() < self._impatience
                timeout_s = self._draw.uniform(0.005, 0.1) if gives_up else 30.0
                rest_s = self._draw.uniform(0.2, 0.6)
            answered = self._send(submission, timeout_s)
            if not answered:
                time.sleep(rest_s)

    def _send(self, submission: Submission, timeout_s: float) -> bool:
        headers: Mapping[str, str] = {"Idempotency-Key": submission.key}
        try:
            answer = httpx.post(
                f"{self._url}/v1/jobs/contours",
                json=submission.body,
                headers=headers,
                timeout=httpx.Timeout(timeout_s, connect=5.0),
                trust_env=False,
            )
        except httpx.TransportError:
            submission.unanswered += 1
            return False
        if answer.status_code != 202:
            submission.statuses.append(answer.status_code)
            return False
        submission.job_ids.append(answer.json()["id"])
        return True
