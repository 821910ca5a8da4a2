"""Thousands of spoilt uploads at a running service, each answer judged, what was taken in kept."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import httpx
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from benchmarks.fuzzing.judging import ANSWERED_WITHIN_S, MEMORY_CAP_BYTES, faults
from benchmarks.fuzzing.running_service import RunningService
from benchmarks.fuzzing.upload import Upload, send
from schemas.messages import JobRequest
from schemas.problem import Problem

Accepted = Callable[[JobRequest, dict[str, bytes]], None]
"""Is given what was accepted: the request as stored, and the inputs by file name."""


class Broken(Exception):  # noqa: N818 - it reads as what happened
    """The service did what it must not; the text says which upload did it, and how."""


@dataclass
class Tally:
    """What came back: answers by status and problem type, and the slowest of them."""

    answers: Counter[str] = field(default_factory=Counter)
    slowest_s: float = 0.0
    peak_memory_bytes: int = 0

    @property
    def sent(self) -> int:
        return self.answers.total()


def barrage(
    service: RunningService,
    uploads: st.SearchStrategy[Upload],
    *,
    examples: int,
    start: int = 1,
    accepted: Accepted | None = None,
) -> Tally:
    """Send `examples` uploads, drawn from `start`; what was accepted is erased again.

    Raises Broken for the first answer that is not as it has to be, for what a refused
    upload leaves in the store, and for memory above the cap; the upload is shrunk first.
    """
    tally = Tally()
    before = set(service.settings.jobs_dir.iterdir())
    with httpx.Client(base_url=service.url, headers=service.headers, timeout=30.0) as client:

        @seed(start)
        @settings(
            max_examples=examples,
            deadline=None,
            database=None,
            phases=(Phase.generate, Phase.shrink),
            suppress_health_check=list(HealthCheck),
        )
        @given(uploads)
        def strike(upload: Upload) -> None:
            answer = send(service.url, upload, service.headers, ANSWERED_WITHIN_S)
            tally.slowest_s = max(tally.slowest_s, answer.seconds)
            tally.answers[_name(answer.status, answer.body)] += 1
            _require(upload, faults(answer))
            if answer.status == 202:
                _take_back(service, client, answer.headers["location"], accepted)
            left = set(service.settings.jobs_dir.iterdir()) - before
            _require(upload, [f"{path.name} is left in the store" for path in sorted(left)])
            tally.peak_memory_bytes = service.peak_memory_bytes()
            if tally.peak_memory_bytes > MEMORY_CAP_BYTES:
                _require(upload, [f"{tally.peak_memory_bytes} bytes resident"])

        strike()
    return tally


def _take_back(
    service: RunningService, client: httpx.Client, location: str, accepted: Accepted | None
) -> None:
    if accepted is not None:
        folder = service.store.folder(location.rpartition("/")[2])
        inputs = {path.name: path.read_bytes() for path in (folder.path / "inputs").iterdir()}
        accepted(folder.request(), inputs)
    client.delete(location).raise_for_status()


def _require(upload: Upload, wrong: list[str]) -> None:
    if wrong:
        raise Broken(f"{upload!r}: {'; '.join(wrong)}")


def _name(status: int | None, body: bytes) -> str:
    if status is None:
        return "closed"
    if status == 202:
        return "202 accepted"
    try:
        return f"{status} {Problem.model_validate_json(body).type.rpartition(':')[2]}"
    except ValueError:
        return f"{status} plain"
