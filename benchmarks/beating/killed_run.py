"""A job of a whole cycle whose computing process is killed in the middle, on a real service."""

import math
import re
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import httpx

from benchmarks.beating.results import KilledRun
from benchmarks.environment import environment
from benchmarks.small_study import QUICK, small_request
from benchmarks.stack import Stack, running
from cli.same_results import Verdict, compare

FRAMES = 25
_MANIFEST = "manifest.json"
"""It says when it was made."""

_WITHIN_S = 300.0
_LOOK_EVERY_S = 0.01

T = TypeVar("T")

State = tuple[int, int]
"""Of a checkpoint's file: another one when it was written once more."""


def killed_run(wanted: int | None = None, settings: Mapping[str, str] | None = None) -> KilledRun:
    """API, Redis and one worker; the kill comes when half of the frames are fitted.

    wanted: frames of the study. settings: of the service; as they come when None.
    """
    where, count = environment(), wanted or FRAMES
    body = beating_request("killed", count)
    with (
        tempfile.TemporaryDirectory(prefix="killed-") as name,
        running(Stack(Path(name), settings or {}, workers=1)) as stack,
        httpx.Client(base_url=stack.url, timeout=30.0, trust_env=False) as client,
    ):
        broken = _Job(client, stack.jobs_dir, body)
        broken.wait(lambda: len(broken.checkpoints()) >= count // 2 or None)
        killed_s = time.monotonic()
        for process in stack.workers[0].children():
            process.kill()
        kept = broken.checkpoints()
        broken.wait(lambda: broken.asked()["attempt"] > 1 or None)
        noticed_s = time.monotonic() - killed_s
        broken.wait(lambda: len(broken.checkpoints()) > len(kept) or None)
        next_frame_s = time.monotonic() - killed_s
        again: set[str] = set()

        def ended() -> dict[str, Any] | None:
            now = broken.checkpoints()
            again.update(key for key in kept.keys() & now.keys() if now[key] != kept[key])
            return broken.ended()

        job = broken.wait(ended)
        broken_s = time.monotonic() - broken.sent_s
        unbroken = _Job(client, stack.jobs_dir, body)
        unbroken.wait(unbroken.ended)
        unbroken_s = time.monotonic() - unbroken.sent_s
        said = "".join(path.read_text() for path in stack.log_dir.iterdir())
        artifacts = compared(unbroken.results_dir, broken.results_dir)
    return KilledRun(
        environment=where,
        frames=count,
        finished=len(kept),
        taken_up=len(kept.keys() & set(re.findall(r"checkpoint (\S+) is taken up", said))),
        fitted_again=len(again),
        attempts=job["attempt"],
        noticed_s=noticed_s,
        next_frame_s=next_frame_s,
        broken_s=broken_s,
        unbroken_s=unbroken_s,
        artifacts=dict(Counter(verdict.value for verdict in artifacts.values())),
        not_the_same=[name for name, verdict in artifacts.items() if not verdict.is_same],
    )


def beating_request(name: str, frames: int) -> dict[str, Any]:
    """The small study, narrowing by a fifth and widening again, in quick frames."""
    body = small_request(name, QUICK, frames=frames)
    study = body["study"]
    study["frames"] = [
        {
            **frame,
            "time_ms": 1000.0 * k / frames,
            "slices": [
                _scaled(slice_, 1.0 - 0.2 * math.sin(math.pi * k / frames) ** 2)
                for slice_ in frame["slices"]
            ],
        }
        for k, frame in enumerate(study["frames"])
    ]
    return body


def compared(then: Path, now: Path) -> dict[str, Verdict]:
    """How every artifact of two runs compares; the manifest is none."""
    names = {path.name for folder in (then, now) for path in folder.iterdir()}
    return {name: compare(name, then, now).verdict for name in sorted(names) if name != _MANIFEST}


class _Job:
    """One job, looked at through the API and in its folder."""

    def __init__(self, client: httpx.Client, jobs_dir: Path, body: dict[str, Any]) -> None:
        self._client = client
        self.sent_s = time.monotonic()
        answer = client.post("/v1/jobs/contours", json=body).raise_for_status().json()
        self._path = answer["id"]
        self._folder = jobs_dir / answer["id"]

    @property
    def results_dir(self) -> Path:
        return self._folder / "results"

    def asked(self) -> dict[str, Any]:
        answer: dict[str, Any] = self._client.get(f"/v1/jobs/{self._path}").json()
        return answer

    def ended(self) -> dict[str, Any] | None:
        """Raises RuntimeError where it ended badly."""
        job = self.asked()
        if job["state"] in ("failed", "cancelled"):
            raise RuntimeError(f"the job {job['state']}: {job['error']}")
        return job if job["state"] == "succeeded" else None

    def checkpoints(self) -> dict[str, State]:
        """By name. A fit of one level leaves one when it is done."""
        folder, found = self._folder / "checkpoints", {}
        for path in folder.glob("frame-*-fit"):
            try:
                status = path.stat()
            except FileNotFoundError:
                continue  # replaced or removed while we look
            found[path.name] = (status.st_ino, status.st_mtime_ns)
        return found

    def wait(self, look: Callable[[], T | None]) -> T:
        """Until `look` finds something. Raises TimeoutError."""
        deadline_s = time.monotonic() + _WITHIN_S
        while (found := look()) is None:
            if time.monotonic() > deadline_s:
                raise TimeoutError(f"the job is at {self.asked()}")
            time.sleep(_LOOK_EVERY_S)
        return found


def _scaled(slice_: dict[str, Any], by: float) -> dict[str, Any]:
    """Its contours about their common middle, in the slice's plane."""
    every = [point for contour in slice_["contours"] for point in contour["points"]]
    middle = [sum(point[axis] for point in every) / len(every) for axis in range(3)]
    contours = [
        {
            **contour,
            "points": [
                [m + by * (x - m) for m, x in zip(middle, point, strict=True)]
                for point in contour["points"]
            ],
        }
        for contour in slice_["contours"]
    ]
    return {**slice_, "contours": contours}
