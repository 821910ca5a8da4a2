"""Accuracy and speed of every method, side by side, in one run.

    python -m benchmarks [--cases DIR] [--out docs]

Writes DIR/benchmarks.md, and results.json and plots into DIR/benchmarks; progress goes to stderr.
"""

import argparse
import itertools
import subprocess
import sys
from pathlib import Path

from benchmarks.cases import folders, is_chosen, phantoms
from benchmarks.environment import environment
from benchmarks.holdout_results import HoldoutResults
from benchmarks.measure import ROOT
from benchmarks.methods import BY_NAME, METHODS
from benchmarks.page import page
from benchmarks.plots.files import draw
from benchmarks.results import CaseFacts, Record, Results, Speed
from benchmarks.run import facts, records
from worker.threads import bind_libraries

SPEED = "speed"
"""What `--only` calls the part that is no case."""


def main() -> None:
    """Measure or read, then write."""
    arguments = _arguments()
    folder: Path = arguments.out / "benchmarks"
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "results.json"
    if arguments.render:
        results = Results.model_validate_json(file.read_bytes())
    else:
        results = _measured(arguments)
        file.write_text(results.model_dump_json(indent=1, exclude_none=True) + "\n")
    plots = {name: f"{folder.name}/{plot.name}" for name, plot in draw(results, folder).items()}
    (arguments.out / "benchmarks.md").write_text(page(results, plots, _left_out(folder)))


def _left_out(folder: Path) -> HoldoutResults | None:
    """What `benchmarks.holdout` measured, in a run of its own."""
    file = folder / "holdout.json"
    return HoldoutResults.model_validate_json(file.read_bytes()) if file.is_file() else None


def _measured(arguments: argparse.Namespace) -> Results:
    only = tuple(arguments.only)
    methods = [m for m in METHODS if not arguments.methods or m.name in arguments.methods]
    where = environment()
    cases: list[CaseFacts] = []
    found: list[Record] = []
    given = folders(arguments.cases, only) if arguments.cases else iter(())
    for case in itertools.chain(phantoms(only), given):
        cases.append(facts(case))
        found += records(case, methods)
    speed = _speed() if is_chosen(SPEED, only) else None
    return Results(environment=where, cases=cases, records=found, speed=speed)


def _speed() -> Speed:
    """In a process of its own: this one has no need of torch, and holds many meshes."""
    bind_libraries(1)
    command = [sys.executable, "-m", "benchmarks.speed"]
    ended = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True)
    return Speed.model_validate_json(ended.stdout)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--cases", type=Path, metavar="DIR", help="folder of cases with references")
    parser.add_argument(
        "--only", action="append", default=[], metavar="WORD", help="cases named so, or speed"
    )
    parser.add_argument("--methods", nargs="+", default=[], choices=list(BY_NAME), metavar="NAME")
    parser.add_argument("--out", type=Path, default=ROOT / "docs", metavar="DIR")
    parser.add_argument(
        "--render", action="store_true", help="write page and plots anew from results.json"
    )
    return parser.parse_args()


if __name__ == "__main__":
    main()
