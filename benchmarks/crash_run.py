"""One run of the crash matrix: a stack, a client, an agent that strikes, and the verdict."""

import random
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import httpx

from benchmarks.outcome_watch import OutcomeWatch
from benchmarks.small_study import QUICK, small_request
from benchmarks.stack import IMPATIENT, Stack, running
from benchmarks.strikes import Strike, Striker, Struck, drawn, gaps_s
from benchmarks.submissions import Client, Submission
from benchmarks.verdict import Judge, Verdict

_MAX_ATTEMPTS = 5
_CALLERS = 6
_IMPATIENCE = 0.15
_STUCK_AFTER_S = 90.0


@dataclass(frozen=True)
class CrashPlan:
    """jobs: submissions. strikes: in all, `wipes` of them wipes. gap_s: mean rest between two."""

    jobs: int
    seed: int
    strikes: int
    wipes: int
    gap_s: float
    arrival_s: float


@dataclass(frozen=True)
class Recovery:
    """After one strike: seconds from the restart until the service was ready, and until the next
    job ended; None where no more jobs were left.
    """

    strike: Strike
    ready_s: float | None
    next_end_s: float | None


@dataclass(frozen=True)
class CrashRun:
    """What came of it."""

    verdict: Verdict
    recoveries: list[Recovery]
    answered: int
    unanswered: int
    put_off: int
    took_s: float
    log_dir: Path


def crash_run(plan: CrashPlan, folder: Path | None = None) -> CrashRun:
    """folder: where data and logs are left; a temporary one by default."""
    draw = random.Random(plan.seed)
    with ExitStack() as open_:
        if folder is None:
            folder = Path(open_.enter_context(tempfile.TemporaryDirectory(prefix="crashes-")))
        settings = {**IMPATIENT, "NEURALMRI_MAX_ATTEMPTS": str(_MAX_ATTEMPTS)}
        stack = open_.enter_context(running(Stack(folder, settings)))
        watch = open_.enter_context(OutcomeWatch(stack.jobs_dir, stack.url))
        client = Client(stack.url, plan.seed, _IMPATIENCE)
        submissions = _submissions(plan)
        began_s = time.time()
        with ThreadPoolExecutor(_CALLERS) as callers:
            sent = [
                callers.submit(_arrive, client, submission, at_s)
                for submission, at_s in zip(submissions, _arrivals(plan, draw), strict=True)
            ]
            struck = _strike(stack, plan, draw, sent, watch)
        _wait_for_ends(stack, submissions, watch)
        took_s = time.time() - began_s
        for submission in submissions:  # a key is known for as long as its job
            client.submit(submission)
        verdict = _judged(stack, submissions, watch)
        # Not in time for the last ones: the watch goes on until the verdict is there.
        recoveries = [
            Recovery(s.strike, watch.next_ready_s(s.over_s), watch.next_end_s(s.over_s))
            for s in struck
        ]
        return CrashRun(
            verdict=verdict,
            recoveries=recoveries,
            answered=sum(len(s.job_ids) for s in submissions),
            unanswered=sum(s.unanswered for s in submissions),
            put_off=sum(len(s.statuses) for s in submissions),
            took_s=took_s,
            log_dir=stack.log_dir,
        )


def _submissions(plan: CrashPlan) -> list[Submission]:
    # Each its own seed, so that no two are the same work.
    return [
        Submission(f"crash-{plan.seed}-{k}", small_request(f"crash-{k}", {**QUICK, "seed": k}))
        for k in range(plan.jobs)
    ]


def _arrivals(plan: CrashPlan, draw: random.Random) -> list[float]:
    """Instants on the monotonic clock, as of a Poisson process."""
    at_s = time.monotonic()
    return [at_s := at_s + draw.expovariate(1.0 / plan.arrival_s) for _ in range(plan.jobs)]


def _arrive(client: Client, submission: Submission, at_s: float) -> None:
    time.sleep(max(0.0, at_s - time.monotonic()))
    client.submit(submission)


def _strike(
    stack: Stack,
    plan: CrashPlan,
    draw: random.Random,
    sent: Sequence["Future[None]"],
    watch: OutcomeWatch,
) -> list[Struck]:
    """Strike until everything was struck, or there is nothing left to do."""
    striker = Striker(stack, draw)
    struck: list[Struck] = []
    for kind, gap_s in zip(
        drawn(draw, plan.strikes, plan.wipes), gaps_s(draw, plan.gap_s), strict=False
    ):
        time.sleep(gap_s)
        if all(future.done() for future in sent) and len(watch.ended_s) >= plan.jobs:
            break
        struck.append(striker.strike(kind))
        ended = f"{len(watch.ended_s)} of {plan.jobs} jobs ended"
        print(f"{len(struck):3d} {kind.value}; {ended}", file=sys.stderr)
    for future in sent:
        future.result()
    return struck


def _wait_for_ends(stack: Stack, submissions: Sequence[Submission], watch: OutcomeWatch) -> None:
    """Until every job that was accepted has ended, or none has for a long time."""
    waiting = {s.job_ids[0] for s in submissions if s.job_ids}
    last_s, ended = time.monotonic(), 0
    while not waiting <= watch.ended_s.keys():
        if len(watch.ended_s) > ended:
            last_s, ended = time.monotonic(), len(watch.ended_s)
        if time.monotonic() - last_s > _STUCK_AFTER_S:
            return  # the verdict names them
        time.sleep(0.2)
    stack.wait_until_ready()


def _judged(stack: Stack, submissions: Sequence[Submission], watch: OutcomeWatch) -> Verdict:
    with httpx.Client(base_url=stack.url, timeout=30.0, trust_env=False) as asking:
        # What a worker could not tell Redis, the reconciler does within a round or two.
        time.sleep(3.0)
        verdict = Judge(asking, stack.jobs_dir, _MAX_ATTEMPTS).judge(submissions)
    verdict.faults.extend(
        f"{job_id}: its outcome was written twice" for job_id in sorted(watch.rewritten)
    )
    for member in stack.members:
        if not member.is_running:
            verdict.faults.append(f"{member.name} ended by itself; see its log")
    return verdict
