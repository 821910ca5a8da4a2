"""Ten thousand jobs whose engine takes no time: what API, workers and Redis hold, and for how long.

    python -m benchmarks.memory [--jobs 10000] [--every 500]

Prints tables, and puts them into docs/reliability.md unless told --dry.
"""

import argparse
from collections.abc import Sequence

from benchmarks.environment import environment
from benchmarks.marked_page import write_between_marks
from benchmarks.measure import ROOT
from benchmarks.memory_run import MemorySample, memory_run, slope_mib
from benchmarks.tables.markdown import number, table

_ROWS = 10


def main() -> None:
    """Run, write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.memory", description=__doc__)
    parser.add_argument("--jobs", type=int, default=10_000)
    parser.add_argument("--every", type=int, default=500, help="jobs between two looks")
    parser.add_argument("--dry", action="store_true", help="print only")
    arguments = parser.parse_args()
    where = environment()
    samples = memory_run(arguments.jobs, arguments.every)
    machine = f"{where.cpu}, {where.cores} cores; {where.load:g} runnable processes before the run."
    text = "\n\n".join([slopes(samples), growth(samples), machine])
    print(text)
    if not arguments.dry:
        write_between_marks(ROOT / "docs" / "reliability.md", "memory", text)


def slopes(samples: Sequence[MemorySample]) -> str:
    """What each holds at the end, and how much more for each 1000 jobs."""
    held = {
        "API": [s.api_mib for s in samples],
        "worker, parent": [s.worker_mib for s in samples],
        "worker, computing process": [s.computing_mib for s in samples],
        "Redis, its data": [s.redis_mib for s in samples],
    }
    rows = [
        (who, number(sizes[-1], 1), number(slope_mib(samples, sizes), 2, sign=True))
        for who, sizes in held.items()
    ]
    return table(("", "at the end, MiB", "for each 1000 jobs, MiB"), rows)


def growth(samples: Sequence[MemorySample]) -> str:
    """Sample by sample, some ten of them."""
    shown = samples[:: max(1, len(samples) // _ROWS)]
    rows = [
        (
            *(str(s.jobs), number(s.api_mib, 1), number(s.computing_mib, 1)),
            *(number(s.redis_mib, 1), str(s.keys)),
            *(number(s.first_round_s, 2), number(s.round_s, 2)),
        )
        for s in shown
    ]
    header = (
        *("jobs", "API, MiB", "computing, MiB", "Redis, MiB", "keys"),
        *("first round, s", "next round, s"),
    )
    return table(header, rows)


if __name__ == "__main__":
    main()
