"""Jobs sent to a service whose processes are killed, stopped, emptied and refused all the while.

    python -m benchmarks.crashes [--jobs 200] [--seed 1] [--strikes 50] [--wipes 2]

Real API, two real workers, a real Redis with an append-only file, real HTTP. Prints a table, puts
it into docs/reliability.md unless told --dry, and exits with 1 where the service broke its word.
"""

import argparse
import sys
from pathlib import Path
from statistics import median

from benchmarks.crash_run import CrashPlan, CrashRun, crash_run
from benchmarks.environment import environment
from benchmarks.marked_page import write_between_marks
from benchmarks.measure import ROOT
from benchmarks.strikes import Strike
from benchmarks.tables.markdown import number, table


def main() -> None:
    """Run, judge, write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.crashes", description=__doc__)
    parser.add_argument("--jobs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--strikes", type=int, help="by default a quarter of the jobs")
    parser.add_argument("--wipes", type=int, default=2)
    parser.add_argument("--gap", type=float, default=3.0, help="mean rest between strikes, s")
    parser.add_argument("--arrival", type=float, default=1.0, help="mean time between jobs, s")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave data and logs there")
    parser.add_argument("--dry", action="store_true", help="print only")
    arguments = parser.parse_args()
    where = environment()
    plan = CrashPlan(
        jobs=arguments.jobs,
        seed=arguments.seed,
        strikes=arguments.strikes or max(1, arguments.jobs // 4),
        wipes=arguments.wipes,
        gap_s=arguments.gap,
        arrival_s=arguments.arrival,
    )
    run = crash_run(plan, arguments.keep)
    machine = f"{where.cpu}, {where.cores} cores; {where.load:g} runnable processes before the run."
    text = "\n\n".join([crash_summary(plan, run), recovery_table(run), machine])
    print(text)
    for fault in run.verdict.faults:
        print(fault, file=sys.stderr)
    if not arguments.dry:
        write_between_marks(ROOT / "docs" / "reliability.md", "crashes", text)
    if run.verdict.faults:
        sys.exit(1)


def crash_summary(plan: CrashPlan, run: CrashRun) -> str:
    """What was sent, and what became of it."""
    verdict = run.verdict
    attempts = ", ".join(f"{jobs} with {count}" for count, jobs in sorted(verdict.attempts.items()))
    rows = [
        ("seed", str(plan.seed)),
        ("submissions", str(plan.jobs)),
        ("strikes", str(len(run.recoveries))),
        ("took", f"{run.took_s:.0f} s"),
        ("requests answered 202, replays among them", str(run.answered)),
        ("requests without an answer, sent again", str(run.unanswered)),
        ("requests put off (503, 409), sent again", str(run.put_off)),
        ("jobs that succeeded, once", str(verdict.succeeded)),
        ("jobs that failed as `worker-lost` at the cap of attempts", str(verdict.worker_lost)),
        ("jobs by attempts", attempts),
        ("faults", str(len(verdict.faults))),
    ]
    return table(("", f"{plan.jobs} jobs"), rows)


def recovery_table(run: CrashRun) -> str:
    """Seconds until things go on, by what was done."""
    rows = []
    for kind in Strike:
        of_kind = [r for r in run.recoveries if r.strike is kind]
        if not of_kind:
            continue
        ready = _spread([r.ready_s for r in of_kind])
        ended = _spread([r.next_end_s for r in of_kind])
        rows.append((kind.value, str(len(of_kind)), *ready, *ended))
    header = (
        *("strike", "times", "ready again, p50 s", "max s"),
        *("next job ended, p50 s", "max s"),
    )
    return table(header, rows)


def _spread(seconds: list[float | None]) -> tuple[str, str]:
    there = [s for s in seconds if s is not None]
    if not there:
        return "-", "-"
    return number(median(there), 1), number(max(there), 1)


if __name__ == "__main__":
    main()
