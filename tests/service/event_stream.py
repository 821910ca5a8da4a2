"""An event stream as its listener sees it."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import httpx

from tests.service.conftest import Api


@dataclass(frozen=True)
class Heard:
    """One event; `data` is what the JSON says."""

    id: str
    event: str
    data: Any


class Stream:
    """An open answer, read event by event. `comments` and `retry_ms` are what came so far."""

    def __init__(self, answer: httpx.Response) -> None:
        self.answer = answer
        self.comments: list[str] = []
        self.retry_ms: int | None = None
        self._lines = answer.iter_lines()

    def __iter__(self) -> Iterator[Heard]:
        fields: dict[str, str] = {}
        for line in self._lines:
            name, _, value = line.partition(":")
            value = value.removeprefix(" ")
            if not line and "data" in fields:
                yield Heard(fields["id"], fields["event"], json.loads(fields["data"]))
                fields = {}
            elif not name and line:
                self.comments.append(value)
            elif name == "retry":
                self.retry_ms = int(value)
            elif line:
                assert name not in fields
                fields[name] = value

    def next(self) -> Heard:
        return next(iter(self))


@contextmanager
def listening(api: Api, job_id: str, last_event_id: str | None = None) -> Iterator[Stream]:
    headers = {"Accept": "text/event-stream"}
    if last_event_id is not None:
        headers["Last-Event-ID"] = last_event_id
    with api.client.stream("GET", f"/v1/jobs/{job_id}/events", headers=headers) as answer:
        assert answer.status_code == 200
        yield Stream(answer)


def heard(api: Api, job_id: str, last_event_id: str | None = None) -> list[Heard]:
    """Everything up to the end of the stream."""
    with listening(api, job_id, last_event_id) as stream:
        return list(stream)
