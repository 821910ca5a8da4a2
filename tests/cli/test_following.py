"""Following a job through servers that break off, hold back, refuse or have no streams."""

import json
import threading
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import httpx
import pytest

from cli.client import Client
from cli.following import follow
from schemas.event import JobEvent
from schemas.job import JobState
from schemas.problem import InputError, InternalError, ProblemType
from tests.cli.test_client import JOB

BREAK = b"break"
"""At this the connection is cut off, in the middle of the answer."""
SILENCE = b"silence"
"""At this nothing more comes, and the connection stays."""

Answer = tuple[int, str, list[bytes]]
EVENTS = "text/event-stream"


def state(name: str, id_: int) -> bytes:
    return f"event: state\ndata: {json.dumps({**JOB, 'state': name})}\nid: {id_}-0\n\n".encode()


def progress(fraction: float, id_: int) -> bytes:
    return f'event: progress\ndata: {{"fraction": {fraction}}}\nid: {id_}-0\n\n'.encode()


def problem(status: int, type_: ProblemType) -> Answer:
    document = InputError(type_, "no", status=status).problem()
    return status, "application/problem+json", [document.model_dump_json().encode()]


class Script:
    """A server that answers each question after events with the next answer, and polls with jobs.

    `asked` is the `Last-Event-ID` of each question; None of each poll.
    """

    def __init__(self, answers: list[Answer | None], jobs: list[dict[str, Any]]) -> None:
        self.asked: list[str | None] = []
        self._answers = iter(answers)
        self._jobs = iter(jobs)
        self.over = threading.Event()

    def answer(self, handler: BaseHTTPRequestHandler) -> None:
        if not handler.path.endswith("/events"):
            self.asked.append(None)
            job = next(self._jobs, None)
            found = job and (200, "application/json", [json.dumps({**JOB, **job}).encode()])
        else:
            self.asked.append(handler.headers.get("Last-Event-ID", ""))
            found = next(self._answers)
        handler.close_connection = True
        if not found:
            return
        status, media_type, chunks = found
        handler.send_response(status)
        handler.send_header("Content-Type", media_type)
        handler.send_header("Transfer-Encoding", "chunked")
        handler.end_headers()
        for chunk in chunks:
            if chunk == BREAK:
                return
            if chunk == SILENCE:
                self.over.wait(10.0)
                return
            handler.wfile.write(f"{len(chunk):x}\r\n".encode() + chunk + b"\r\n")
        handler.wfile.write(b"0\r\n\r\n")


@pytest.fixture
def run(
    monkeypatch: pytest.MonkeyPatch,
) -> Iterator[Callable[[Script], tuple[JobState, list[JobEvent]]]]:
    monkeypatch.setattr("cli.following._AGAIN_AFTER_S", 0.02)
    monkeypatch.setattr("cli.client._POLL_EVERY_S", 0.02)
    monkeypatch.setattr("cli.connection._TIMEOUT", httpx.Timeout(5.0, read=0.5))
    started: list[tuple[ThreadingHTTPServer, Script]] = []

    def start(script: Script) -> tuple[JobState, list[JobEvent]]:
        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_GET(self) -> None:
                script.answer(self)

            def log_request(self, code: object = "-", size: object = "-") -> None:
                """Tests are quiet."""

        server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        started.append((server, script))
        heard: list[JobEvent] = []
        url = f"http://127.0.0.1:{server.server_address[1]}"
        with Client(url, patience_s=0.3) as client:
            job = follow(client, JOB["id"], heard.append)
        return job.state, heard

    yield start
    for server, script in started:
        script.over.set()
        server.shutdown()
        server.server_close()


def ids(heard: list[JobEvent]) -> list[str | None]:
    return [event.id for event in heard]


def test_one_connection_is_enough_where_nothing_breaks(run: Any) -> None:
    script = Script(
        [(200, EVENTS, [state("running", 1), progress(0.5, 2), state("failed", 3)])], []
    )
    ended, heard = run(script)
    assert ended is JobState.FAILED
    assert ids(heard) == ["1-0", "2-0", "3-0"]
    assert script.asked == [""]


def test_each_lost_connection_is_gone_on_from_where_it_broke(run: Any) -> None:
    half = progress(0.4, 3)
    script = Script(
        [
            None,
            (200, EVENTS, [state("running", 1), progress(0.2, 2), half[:20], BREAK]),
            None,
            (200, EVENTS, [half, b": still here\n\n", SILENCE]),
            (200, EVENTS, [progress(0.5, 4)]),  # the server stops in good order
            (200, EVENTS, [state("succeeded", 5)]),
        ],
        [],
    )
    ended, heard = run(script)
    assert ended is JobState.SUCCEEDED
    assert ids(heard) == ["1-0", "2-0", "3-0", "4-0", "5-0"]
    assert script.asked == ["", "", "2-0", "2-0", "3-0", "4-0"]


@pytest.mark.parametrize(
    "answer",
    [
        problem(503, ProblemType.UNAVAILABLE),
        problem(406, ProblemType.NOT_ACCEPTABLE),
        problem(404, ProblemType.NOT_FOUND),
        (502, "text/html", [b"<html>bad gateway"]),
        (200, "text/html", [b"<html>hello"]),
        (200, EVENTS, [b"event: state\ndata: hello\n\n"]),
        (200, EVENTS, [b": kept back by a proxy\n\n", SILENCE]),
    ],
    ids=["full", "refused", "older server", "gateway", "page", "nonsense", "held back"],
)
def test_where_no_stream_is_to_be_had_the_job_is_polled(run: Any, answer: Answer) -> None:
    polled = [
        {"state": "queued"},
        {"state": "queued"},
        {"state": "running", "attempt": 1, "progress": {"fraction": 0.1}},
        {"state": "running", "attempt": 1, "progress": {"fraction": 0.2}},
        {"state": "succeeded", "attempt": 1, "progress": {"fraction": 1.0}},
    ]
    script = Script([answer], polled)
    ended, heard = run(script)
    assert ended is JobState.SUCCEEDED
    assert [event.event for event in heard] == ["state", "state", "progress", "state"]
    assert ids(heard) == [None] * 4
    assert script.asked == ["", *[None] * 5]


def test_a_job_whose_end_was_told_before_is_looked_at(run: Any) -> None:
    script = Script([(204, EVENTS, [])], [{"state": "cancelled"}])
    assert run(script) == (JobState.CANCELLED, [])


def test_a_server_that_stays_away_is_given_up_without_condemning_the_job(run: Any) -> None:
    with pytest.raises(InternalError, match="it may go on"):
        run(Script([(200, EVENTS, [state("running", 1), BREAK]), *[None] * 1000], []))


def test_kinds_of_events_that_are_not_known_are_left_out(run: Any) -> None:
    news = b'event: news\ndata: {"x": 1}\nid: 2-0\n\n'
    _, heard = run(Script([(200, EVENTS, [news, state("succeeded", 3)])], []))
    assert ids(heard) == ["3-0"]
