"""Fifty requests a second to a service whose workers are busy with real fits.

    python -m benchmarks.load [--rate 50] [--seconds 60] [--rounds 3]

The requests go by a fixed schedule and are timed from it (`benchmarks.open_loop`). Prints tables,
and puts them into docs/reliability.md unless told --dry. --profile FILE has py-spy sample the API.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from benchmarks.environment import environment
from benchmarks.load_plan import Route
from benchmarks.load_run import LoadRound, load_round
from benchmarks.marked_page import write_between_marks
from benchmarks.measure import ROOT
from benchmarks.stack import Stack, running
from benchmarks.tables.markdown import number, table


def main() -> None:
    """Run the rounds, write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.load", description=__doc__)
    parser.add_argument("--rate", type=float, default=50.0, help="requests a second")
    parser.add_argument("--seconds", type=float, default=60.0, help="of each round")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--profile", type=Path, metavar="FILE", help="stacks of the API, collapsed")
    parser.add_argument("--dry", action="store_true", help="print only")
    arguments = parser.parse_args()
    where = environment()
    rounds = []
    with ExitStack() as open_:
        folder = open_.enter_context(tempfile.TemporaryDirectory(prefix="load-"))
        stack = open_.enter_context(running(Stack(Path(folder), {})))
        for place in range(arguments.rounds):
            seed = arguments.seed + place
            rounds.append(
                load_round(stack, arguments.rate, arguments.seconds, seed, arguments.profile)
            )
            print(f"round {place + 1} is done", file=sys.stderr)
    quietest = min(rounds, key=lambda done: _percentile_ms(done, Route.JOB, 99.0))
    sent = f"{arguments.rate:g} requests a second for {arguments.seconds:g} s"
    text = "\n\n".join(
        [
            f"{sent}, submissions of {quietest.body_bytes} bytes; the quietest round:",
            route_table(quietest),
            "Every round:",
            round_table(rounds),
            f"{where.cpu}, {where.cores} cores; {where.load:g} runnable processes before the run.",
        ]
    )
    print(text)
    if not arguments.dry:
        write_between_marks(ROOT / "docs" / "reliability.md", "load", text)


def route_table(done: LoadRound) -> str:
    """Latencies from the schedule, by route."""
    rows = []
    for route in Route:
        samples = [s for s in done.samples.done if s.route is route]
        errors = sum(not 200 <= s.status < 300 for s in samples)
        spread = [_ms(_percentile_ms(done, route, p)) for p in (50.0, 95.0, 99.0, 100.0)]
        rows.append((route.value, str(len(samples)), *spread, str(errors)))
    return table(("route", "answered", "p50 ms", "p95 ms", "p99 ms", "max ms", "errors"), rows)


def round_table(rounds: Sequence[LoadRound]) -> str:
    """What each round says of the machine and of the API as a whole."""
    rows = []
    for place, done in enumerate(rounds, start=1):
        samples = done.samples.done
        late_ms = 1000.0 * float(np.percentile([s.late_s for s in samples], 99.0))
        cpu_ms = 1000.0 * done.api_cpu_s / len(samples)
        found = (_percentile_ms(done, Route.JOB, 99.0), late_ms)
        row = (str(place), *map(_ms, found), number(cpu_ms, 1), number(done.rss_mib, 0))
        rows.append((*row, str(done.samples.dropped), number(done.load, 1)))
    header = (
        *("round", "GET job, p99 ms", "client late, p99 ms", "API's CPU a request, ms"),
        *("API's memory, MiB", "dropped", "load average"),
    )
    return table(header, rows)


def _percentile_ms(done: LoadRound, route: Route, percent: float) -> float:
    latencies = [s.latency_s for s in done.samples.done if s.route is route]
    return 1000.0 * float(np.percentile(latencies, percent)) if latencies else float("nan")


def _ms(value: float) -> str:
    return number(value, 0 if value >= 10.0 else 1)


if __name__ == "__main__":
    main()
