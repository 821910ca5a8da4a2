"""The client against servers that answer badly, late, or not at all. Each is a real HTTP server."""

import hashlib
import json
import threading
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from cli.client import Client
from cli.server_errors import ended_badly
from schemas.job import Job, JobState, Progress
from schemas.problem import InputError, InternalError, ProblemType

JOB = {
    "id": "1" * 32,
    "kind": "contours",
    "created_at": "2026-01-02T03:04:05Z",
    "links": {"self": "/s", "cancel": "/c", "report": "/r", "artifacts": "/a"},
}

Answer = tuple[int, bytes]
Serve = Callable[[Callable[[str], Answer | None]], str]


def job(state: str, fraction: float = 0.0) -> Answer:
    return 200, json.dumps({**JOB, "state": state, "progress": {"fraction": fraction}}).encode()


@pytest.fixture
def serve() -> Iterator[Serve]:
    """Serves a function from path to answer; None is a connection cut off without one."""
    servers: list[ThreadingHTTPServer] = []

    def start(answer: Callable[[str], Answer | None]) -> str:
        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                given = answer(self.path)
                if given is None:
                    self.close_connection = True
                    return
                self.send_response(given[0])
                self.send_header("Content-Length", str(len(given[1])))
                self.end_headers()
                self.wfile.write(given[1])

            def log_request(self, code: object = "-", size: object = "-") -> None:
                """Tests are quiet."""

        server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        servers.append(server)
        return f"http://127.0.0.1:{server.server_address[1]}"

    yield start
    for server in servers:
        server.shutdown()
        server.server_close()


@pytest.fixture(autouse=True)
def _hasty(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cli.client._POLL_EVERY_S", 0.02)


def test_a_lost_connection_and_a_failing_server_are_no_verdict(serve: Serve) -> None:
    answers: Iterator[Answer | None] = iter(
        [job("running", 0.5), None, (502, b"<html>bad gateway"), None, job("succeeded", 1.0)]
    )
    seen: list[Progress] = []
    with Client(serve(lambda _: next(answers))) as client:
        done = client.poll(JOB["id"], lambda job: seen.append(job.progress))
    assert done.state is JobState.SUCCEEDED
    assert [p.fraction for p in seen] == [0.5, 1.0]


def test_a_server_that_stays_away_is_given_up_without_condemning_the_job(serve: Serve) -> None:
    with (
        Client(serve(lambda _: None), patience_s=0.2) as client,
        pytest.raises(InternalError, match="it may go on"),
    ):
        client.poll(JOB["id"], lambda _: None)


def test_a_job_that_is_not_there_is_told_at_once(serve: Serve) -> None:
    problem = InputError(ProblemType.NOT_FOUND, "there is no such job", status=404).problem()
    url = serve(lambda _: (404, problem.model_dump_json().encode()))
    with Client(url) as client, pytest.raises(InputError, match="no such job") as told:
        client.poll(JOB["id"], lambda _: None)
    assert told.value.type is ProblemType.NOT_FOUND
    assert told.value.status == 404


def test_another_server_than_ours_is_recognised(serve: Serve) -> None:
    url = serve(lambda _: (200, b"<html>hello"))
    with Client(url) as client, pytest.raises(InternalError, match="is it a neuralmri server"):
        client.job(JOB["id"])


def test_another_service_that_speaks_json_is_recognised_too(serve: Serve) -> None:
    url = serve(lambda _: (200, b'{"hello": "world"}'))
    with Client(url) as client, pytest.raises(InternalError, match="is it a neuralmri server"):
        client.job(JOB["id"])


def artifacts(content: bytes, sha256: str) -> Callable[[str], Answer]:
    listed = {
        "subject_id": "case-01",
        "axes": "LPS",
        "created_at": "2026-01-02T03:04:05Z",
        "software": "neuralmri 0",
        "artifacts": [
            {
                "name": "ED_lv_endo.stl",
                "media_type": "model/stl",
                "bytes": len(content),
                "sha256": sha256,
            }
        ],
    }

    def answer(path: str) -> Answer:
        return 200, json.dumps(listed).encode() if path.endswith("/artifacts") else content

    return answer


def test_a_download_arrives_whole_with_its_manifest(serve: Serve, tmp_path: Path) -> None:
    url = serve(artifacts(b"mesh", hashlib.sha256(b"mesh").hexdigest()))
    with Client(url) as client:
        client.download(JOB["id"], tmp_path)
    assert (tmp_path / "ED_lv_endo.stl").read_bytes() == b"mesh"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["ED_lv_endo.stl", "manifest.json"]


def test_a_damaged_download_is_refused_and_leaves_nothing(serve: Serve, tmp_path: Path) -> None:
    url = serve(artifacts(b"damaged", hashlib.sha256(b"mesh").hexdigest()))
    with Client(url) as client, pytest.raises(InternalError, match="damaged"):
        client.download(JOB["id"], tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("error", [None, InputError(ProblemType.TOO_FEW_SLICES, "more slices")])
def test_an_end_without_success_is_an_error_for_who_waited(error: InputError | None) -> None:
    state = JobState.FAILED if error else JobState.CANCELLED
    ended = Job.model_validate({**JOB, "state": state, "error": error and error.problem()})
    failure = ended_badly(ended)
    assert isinstance(failure, InputError)
    assert ("more slices" if error else "cancelled") in failure.detail


def test_success_is_no_error() -> None:
    assert ended_badly(Job.model_validate({**JOB, "state": JobState.SUCCEEDED})) is None
