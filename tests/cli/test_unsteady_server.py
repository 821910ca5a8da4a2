"""The client against a server that breaks off, is busy, or sends something else the second time."""

import hashlib
import json
import re
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from cli.client import Client
from cli.inputs import ContourInput, LabelInput
from schemas.labels import LabelRequest
from schemas.messages import ContourRequest
from schemas.problem import InputError, InternalError, ProblemType
from schemas.vocabulary import View
from tests.cli.test_client import JOB
from tests.studies.ellipsoid import good_request

MESH = bytes(range(256)) * 4000
SHA256 = hashlib.sha256(MESH).hexdigest()
BUSY = InternalError(ProblemType.UNAVAILABLE, "busy", status=503).problem().model_dump_json()
MANIFEST = {
    "subject_id": "case-01",
    "axes": "LPS",
    "created_at": "2026-01-02T03:04:05Z",
    "software": "neuralmri 0",
    "artifacts": [
        {"name": "a.stl", "media_type": "model/stl", "bytes": len(MESH), "sha256": SHA256},
        {"name": "b.stl", "media_type": "model/stl", "bytes": len(MESH), "sha256": SHA256},
    ],
}


@dataclass
class Unsteady:
    """A server whose first answers are bad.

    cuts: after how many bytes of a file to break off, one a request.
    busy: how often to answer 503 or 429 first. lose: how many submissions to take and not answer.
    """

    cuts: list[int] = field(default_factory=list)
    busy: list[int] = field(default_factory=list)
    lose: int = 0
    mesh: bytes = MESH
    ranges: list[str | None] = field(default_factory=list)
    keys: list[str] = field(default_factory=list)
    bodies: list[bytes] = field(default_factory=list)

    def handler(self) -> type[BaseHTTPRequestHandler]:
        unsteady = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                if unsteady.busy:
                    self.answer(unsteady.busy.pop(0), BUSY.encode())
                elif self.path.endswith("/artifacts"):
                    self.answer(200, json.dumps(MANIFEST).encode())
                else:
                    self.file()

            def do_POST(self) -> None:
                body = self.rfile.read(int(self.headers["Content-Length"]))
                unsteady.bodies.append(body)
                unsteady.keys.append(self.headers["Idempotency-Key"])
                if unsteady.busy:
                    self.answer(unsteady.busy.pop(0), BUSY.encode())
                elif len(unsteady.bodies) <= unsteady.lose:
                    self.close_connection = True
                else:
                    self.answer(202, json.dumps({**JOB, "state": "queued"}).encode())

            def file(self) -> None:
                asked = self.headers["Range"]
                unsteady.ranges.append(asked)
                first = int(re.fullmatch(r"bytes=(\d+)-", asked)[1]) if asked else 0
                assert self.headers["If-Range"] == (f'"{SHA256}"' if asked else None)
                self.send_response(206 if asked else 200)
                rest = unsteady.mesh[first:]
                self.send_header("Content-Length", str(len(rest)))
                if asked:
                    size = len(unsteady.mesh)
                    self.send_header("Content-Range", f"bytes {first}-{size - 1}/{size}")
                self.end_headers()
                cut = unsteady.cuts.pop(0) if unsteady.cuts else len(rest)
                self.wfile.write(rest[:cut])
                self.close_connection = True

            def answer(self, status: int, body: bytes) -> None:
                self.send_response(status)
                self.send_header("Content-Length", str(len(body)))
                if status in (409, 429, 503):
                    self.send_header("Retry-After", "0")
                self.end_headers()
                self.wfile.write(body)

            def log_request(self, code: object = "-", size: object = "-") -> None:
                """Tests are quiet."""

        return Handler


Start = Callable[[Unsteady, float], Client]


@pytest.fixture
def start(monkeypatch: pytest.MonkeyPatch) -> Iterator[Start]:
    """A client of an unsteady server, in a hurry."""
    monkeypatch.setattr("cli.retrying._FIRST_PAUSE_S", 0.02)
    servers: list[ThreadingHTTPServer] = []
    clients: list[Client] = []

    def run(unsteady: Unsteady, retry_within_s: float = 5.0) -> Client:
        server = ThreadingHTTPServer(("127.0.0.1", 0), unsteady.handler())
        threading.Thread(target=server.serve_forever, daemon=True).start()
        servers.append(server)
        url = f"http://127.0.0.1:{server.server_address[1]}"
        clients.append(Client(url, retry_within_s=retry_within_s))
        return clients[-1]

    yield run
    for client in clients:
        client.__exit__(None, None, None)
    for server in servers:
        server.shutdown()
        server.server_close()


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_download_that_breaks_off_goes_on_where_it_did(start: Start, tmp_path: Path) -> None:
    unsteady = Unsteady(cuts=[70_000, 80_000])
    start(unsteady, 5.0).download(JOB["id"], tmp_path, ["a.stl"])
    assert (tmp_path / "a.stl").read_bytes() == MESH
    assert names(tmp_path) == ["a.stl"]
    whole, *rest = unsteady.ranges
    assert whole is None
    assert [int(text.removeprefix("bytes=").rstrip("-")) > 0 for text in rest if text] == [True] * 2


def test_another_run_goes_on_too_and_a_whole_file_is_not_fetched_again(
    start: Start, tmp_path: Path
) -> None:
    with pytest.raises(InternalError, match="run the command again"):
        start(Unsteady(cuts=[70_000]), 0.0).download(JOB["id"], tmp_path)
    (part,) = names(tmp_path)
    assert part.startswith(".a.stl.")
    had = (tmp_path / part).stat().st_size
    assert 0 < had <= 70_000
    unsteady = Unsteady()
    client = start(unsteady, 0.0)
    client.download(JOB["id"], tmp_path)
    assert unsteady.ranges == [f"bytes={had}-", None]
    assert names(tmp_path) == ["a.stl", "b.stl", "manifest.json"]
    client.download(JOB["id"], tmp_path)
    assert len(unsteady.ranges) == 2
    (tmp_path / "a.stl").write_bytes(b"changed by someone")
    client.download(JOB["id"], tmp_path)
    assert (tmp_path / "a.stl").read_bytes() == MESH


@pytest.mark.parametrize("left", [MESH[:1000][::-1], MESH + b"more", MESH[::-1]])
def test_what_is_left_of_something_else_is_begun_anew(
    start: Start, left: bytes, tmp_path: Path
) -> None:
    (tmp_path / f".a.stl.{SHA256[:16]}.part").write_bytes(left)
    start(Unsteady(), 5.0).download(JOB["id"], tmp_path, ["a.stl"])
    assert (tmp_path / "a.stl").read_bytes() == MESH
    assert names(tmp_path) == ["a.stl"]


@pytest.mark.parametrize("mesh", [MESH[::-1], MESH + b"more", MESH[:-1]])
def test_a_file_that_is_not_the_listed_one_leaves_nothing(
    start: Start, mesh: bytes, tmp_path: Path
) -> None:
    with pytest.raises(InternalError, match="damaged"):
        start(Unsteady(mesh=mesh), 1.0).download(JOB["id"], tmp_path)
    assert names(tmp_path) == []


def test_only_named_files_are_fetched_and_unknown_names_are_told(
    start: Start, tmp_path: Path
) -> None:
    client = start(Unsteady(), 5.0)
    client.download(JOB["id"], tmp_path / "one", ["b.stl"])
    assert names(tmp_path / "one") == ["b.stl"]
    with pytest.raises(InputError, match=r"a\.stl, b\.stl"):
        client.download(JOB["id"], tmp_path / "none", ["c.stl"])
    assert not (tmp_path / "none").exists()


def given(kind: str, folder: Path) -> ContourInput | LabelInput:
    if kind == "contours":
        return ContourInput(ContourRequest.model_validate(good_request()), "/study")
    (folder / "sax.nii").write_bytes(b"voxels" * 100_000)
    request = LabelRequest.model_validate({"subject_id": "a", "label_scheme": "acdc"})
    return LabelInput(request, {View.SAX: folder / "sax.nii"})


@pytest.mark.parametrize("kind", ["contours", "labels"])
@pytest.mark.parametrize(
    ("lose", "busy"), [(2, ()), (0, (503, 429)), (0, (502, 504)), (0, (409, 409))]
)
def test_a_submission_is_sent_again_whole_and_under_one_key(
    start: Start, kind: str, lose: int, busy: tuple[int, ...], tmp_path: Path
) -> None:
    unsteady = Unsteady(lose=lose, busy=list(busy))
    job = start(unsteady, 10.0).submit(given(kind, tmp_path))
    assert job.id == JOB["id"]
    assert len(unsteady.bodies) == 3
    assert len(set(unsteady.keys)) == 1
    assert re.fullmatch(r"[0-9a-f]{32}", unsteady.keys[0])
    assert {len(body) for body in unsteady.bodies} == {len(unsteady.bodies[0])}
    assert kind == "contours" or b"voxels" * 100_000 in unsteady.bodies[-1]


def test_two_submissions_have_two_keys(start: Start, tmp_path: Path) -> None:
    unsteady = Unsteady()
    client = start(unsteady, 5.0)
    for _ in range(2):
        client.submit(given("contours", tmp_path))
    assert len(set(unsteady.keys)) == 2


def test_an_ordinary_conflict_is_no_reason_to_ask_again(start: Start, tmp_path: Path) -> None:
    unsteady = Unsteady(busy=[409, 409])
    with pytest.raises(InternalError):
        start(unsteady, 5.0).download(JOB["id"], tmp_path)
    assert unsteady.busy == [409]
