"""A crash matrix in small, and that its judge finds what it looks for."""

import hashlib
import json
import random
from collections import Counter
from pathlib import Path
from typing import Any

import httpx
import pytest

from benchmarks.crash_run import CrashPlan, CrashRun, Recovery, crash_run
from benchmarks.crashes import crash_summary, recovery_table
from benchmarks.strikes import Strike, drawn
from benchmarks.submissions import Submission
from benchmarks.verdict import Judge, Verdict

ID = "0" * 32
PLAN = CrashPlan(jobs=24, seed=7, strikes=9, wipes=1, gap_s=1.5, arrival_s=0.5)


@pytest.mark.slow
@pytest.mark.integration
@pytest.mark.timeout(900)
def test_whatever_dies_each_submission_becomes_one_job_that_ends_once(tmp_path: Path) -> None:
    run = crash_run(PLAN, tmp_path / "run")
    assert run.verdict.faults == []
    assert run.verdict.succeeded == PLAN.jobs
    assert run.answered >= 2 * PLAN.jobs  # each key was asked for once more at the end
    assert {recovery.strike for recovery in run.recoveries} <= set(Strike)


def test_every_kind_of_strike_is_drawn_and_as_many_wipes_as_asked_for() -> None:
    chosen = drawn(random.Random(3), 50, 2)
    assert len(chosen) == 50
    assert set(chosen) == set(Strike)
    assert chosen.count(Strike.WIPE) == 2
    assert chosen == drawn(random.Random(3), 50, 2)


def test_a_submission_complains_of_two_jobs_of_none_and_of_other_answers() -> None:
    kept = Submission("kept", {}, job_ids=["a", "a"], unanswered=3, statuses=[503, 409])
    assert kept.faults == []
    assert Submission("lost", {}).faults == ["lost: never accepted"]
    assert Submission("twice", {}, job_ids=["a", "b"]).faults == ["twice: was given 2 jobs"]
    assert Submission("broken", {}, ["a"], statuses=[500]).faults == ["broken: answered 500"]


class House:
    """A job's folder and what the API says of it, to be spoilt in one place at a time."""

    def __init__(self, jobs_dir: Path) -> None:
        self.jobs_dir = jobs_dir
        self.job: dict[str, Any] = {"id": ID, "state": "succeeded", "attempt": 1, "error": None}
        self.last_event = "succeeded"
        self.listed = [ID]
        self.mesh = b"solid"
        folder = self.folder = jobs_dir / ID
        (folder / "results").mkdir(parents=True)
        (folder / "inputs").mkdir()
        (folder / "request.json").write_text('{"idempotency": {"key": "k"}}')
        (folder / "outcome.json").write_text(json.dumps(self.job))
        (folder / "results" / "a.stl").write_bytes(self.mesh)
        sha256 = hashlib.sha256(self.mesh).hexdigest()
        manifest = {"artifacts": [{"name": "a.stl", "sha256": sha256}]}
        (folder / "results" / "manifest.json").write_text(json.dumps(manifest))

    def answer(self, request: httpx.Request) -> httpx.Response:
        match request.url.path.split("/")[3:]:
            case []:
                return httpx.Response(200, json=self.page())
            case [_]:
                return httpx.Response(200, json=self.job)
            case [_, "events"]:
                told = json.dumps({"state": self.last_event})
                return httpx.Response(200, text=f"event: state\ndata: {told}\n\n")
        return httpx.Response(200, content=self.mesh)

    def page(self) -> dict[str, Any]:
        return {"jobs": [{"id": id_} for id_ in self.listed], "next_cursor": None}

    def verdict(self) -> Verdict:
        transport = httpx.MockTransport(self.answer)
        with httpx.Client(base_url="http://service", transport=transport) as client:
            return Judge(client, self.jobs_dir, 5).judge([Submission("k", {}, [ID, ID])])


@pytest.fixture
def house(tmp_path: Path) -> House:
    return House(tmp_path)


def test_a_whole_house_has_no_faults(house: House) -> None:
    found = house.verdict()
    assert found == Verdict([], succeeded=1, worker_lost=0, attempts=Counter({1: 1}))


def test_the_judge_names_what_is_wrong(house: House) -> None:
    house.mesh = b"broken"
    house.last_event = "running"
    house.listed = []
    house.job["attempt"] = 6
    (house.folder / "staging-1").mkdir()
    (house.folder / "results" / "b.stl").touch()
    (house.jobs_dir / ("1" * 32)).mkdir()
    (house.jobs_dir / ("1" * 32) / "request.json").write_text('{"idempotency": {"key": "k"}}')
    told = "\n".join(house.verdict().faults)
    for part in (
        "there are ['0000",
        "6 attempts",
        "attempt is 6, in its folder 1",
        "staging-1",
        "the manifest names ['a.stl']",
        "artifact a.stl is not what",
        "its events end with running",
        "the list has 0 jobs",
    ):
        assert part in told


def test_a_job_that_failed_is_a_fault_unless_its_attempts_were_used_up(house: House) -> None:
    lost = {"type": "urn:neuralmri:problem:worker-lost"}
    for attempt, faults in ((1, 1), (5, 0)):
        house.job.update(state="failed", attempt=attempt, error=lost)
        house.last_event = "failed"
        (house.folder / "outcome.json").write_text(json.dumps(house.job))
        found = house.verdict()
        assert len(found.faults) == faults
        assert found.worker_lost == 1 - faults


def test_tables_say_what_was_done_and_how_long_it_took_to_recover() -> None:
    recoveries = [
        Recovery(Strike.API, 1.0, 2.0),
        Recovery(Strike.API, 3.0, None),
        Recovery(Strike.WIPE, None, None),
    ]
    run = CrashRun(
        verdict=Verdict([], 24, 0, Counter({1: 20, 2: 4})),
        recoveries=recoveries,
        answered=48,
        unanswered=7,
        put_off=3,
        took_s=60.0,
        log_dir=Path("logs"),
    )
    assert "| jobs by attempts | 20 with 1, 4 with 2 |" in crash_summary(PLAN, run)
    rows = recovery_table(run).splitlines()
    assert rows[2] == "| API killed | 2 | 2.0 | 3.0 | 2.0 | 2.0 |"
    assert rows[3] == "| Redis killed, its data removed | 1 | - | - | - | - |"
