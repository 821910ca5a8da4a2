"""Whether a service kept its word, judged by what it answers and by what lies in its folders."""

import hashlib
import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx

from benchmarks.submissions import Submission
from schemas.problem import ProblemType

_WHOLE = ["inputs", "outcome.json", "request.json", "results"]
"""What is left of a job that succeeded, whatever happened to its workers."""


@dataclass(frozen=True)
class Verdict:
    """faults: every one, empty for a service that kept its word.

    succeeded, worker_lost: how jobs ended. attempts: how many jobs took how many.
    """

    faults: list[str]
    succeeded: int
    worker_lost: int
    attempts: Counter[int]


class Judge:
    """Asks over HTTP and reads folders; nothing else is known to it."""

    def __init__(self, client: httpx.Client, jobs_dir: Path, max_attempts: int) -> None:
        self._client = client
        self._jobs_dir = jobs_dir
        self._max_attempts = max_attempts
        self._succeeded = 0
        self._worker_lost = 0
        self._attempts: Counter[int] = Counter()

    def judge(self, submissions: Sequence[Submission]) -> Verdict:
        """Every job is to have ended before."""
        faults = [fault for submission in submissions for fault in submission.faults]
        faults += self._folders_by_key(submissions)
        for submission in submissions:
            for job_id in dict.fromkeys(submission.job_ids):
                faults += [f"{job_id}: {fault}" for fault in self._of_job(job_id)]
        faults += self._listed(submissions)
        return Verdict(faults, self._succeeded, self._worker_lost, self._attempts)

    def _folders_by_key(self, submissions: Sequence[Submission]) -> Iterator[str]:
        """One folder a key, the one that its caller was told of, and no other."""
        told = {s.key: s.job_ids[0] for s in submissions if s.job_ids}
        made: dict[str, list[str]] = {}
        for path in sorted(self._jobs_dir.iterdir()):
            if not re.fullmatch("[0-9a-f]{32}", path.name):
                yield f"{path.name} was left among the jobs"
                continue
            request = json.loads((path / "request.json").read_bytes())
            made.setdefault(request["idempotency"]["key"], []).append(path.name)
        for key in sorted(told.keys() | made.keys()):
            if made.get(key, []) != [told.get(key)]:
                yield f"{key}: the caller was told of {told.get(key)}, there are {made.get(key)}"

    def _of_job(self, job_id: str) -> Iterator[str]:
        answer = self._client.get(f"/v1/jobs/{job_id}")
        if answer.status_code != 200:
            yield f"is lost: {answer.status_code}"
            return
        job = answer.json()
        self._attempts[job["attempt"]] += 1
        if job["attempt"] > self._max_attempts:
            yield f"took {job['attempt']} attempts"
        yield from self._outcome(job)
        if job["state"] == "succeeded":
            self._succeeded += 1
            yield from self._results(job_id)
        elif self._was_given_up(job):
            self._worker_lost += 1
        else:
            yield f"is {job['state']} after {job['attempt']} attempts: {job['error']}"
        last = self._last_state_told(job_id)
        if last != job["state"]:
            yield f"is {job['state']}, its events end with {last}"

    def _was_given_up(self, job: Mapping[str, Any]) -> bool:
        """Whether it failed for want of a worker that lived, after as many as it may have."""
        lost = job["error"] is not None and job["error"]["type"] == ProblemType.WORKER_LOST.uri
        return bool(lost and job["attempt"] >= self._max_attempts)

    def _outcome(self, job: Mapping[str, Any]) -> Iterator[str]:
        """The folder's word and Redis's are the same."""
        try:
            outcome = json.loads((self._jobs_dir / job["id"] / "outcome.json").read_bytes())
        except FileNotFoundError:
            yield f"is {job['state']} without an outcome"
            return
        for name in ("state", "attempt", "error"):
            if outcome[name] != job[name]:
                yield f"{name} is {job[name]}, in its folder {outcome[name]}"

    def _results(self, job_id: str) -> Iterator[str]:
        folder = self._jobs_dir / job_id
        inside = sorted(path.name for path in folder.iterdir())
        if inside != _WHOLE:
            yield f"holds {inside}"
        manifest = json.loads((folder / "results" / "manifest.json").read_bytes())
        named = {artifact["name"]: artifact["sha256"] for artifact in manifest["artifacts"]}
        there = {path.name for path in (folder / "results").iterdir()} - {"manifest.json"}
        if there != named.keys():
            yield f"results are {sorted(there)}, the manifest names {sorted(named)}"
        for name, sha256 in named.items():
            got = self._client.get(f"/v1/jobs/{job_id}/artifacts/{name}")
            if got.status_code != 200 or hashlib.sha256(got.content).hexdigest() != sha256:
                yield f"artifact {name} is not what the manifest says ({got.status_code})"

    def _last_state_told(self, job_id: str) -> str | None:
        """The state with which the job's event stream ends."""
        last = None
        with self._client.stream("GET", f"/v1/jobs/{job_id}/events") as answer:
            kind = ""
            for line in answer.iter_lines():
                if line.startswith("event:"):
                    kind = line.partition(":")[2].strip()
                elif line.startswith("data:") and kind == "state":
                    last = json.loads(line.partition(":")[2])["state"]
        return last

    def _listed(self, submissions: Sequence[Submission]) -> Iterator[str]:
        """The list has every job once."""
        expected = sorted(s.job_ids[0] for s in submissions if s.job_ids)
        listed: list[str] = []
        page: dict[str, Any] = {"next_cursor": ""}
        while (cursor := page["next_cursor"]) is not None:
            asked = {"limit": "200", **({"cursor": cursor} if cursor else {})}
            page = self._client.get("/v1/jobs", params=asked).json()
            listed += [job["id"] for job in page["jobs"]]
        if sorted(listed) != expected:
            yield f"the list has {len(listed)} jobs, and {len(expected)} were accepted"
