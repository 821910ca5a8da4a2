"""What a whole beating heart costs, and how close it comes, in four parts.

    python -m benchmarks.beating [--data DIR] [--only PART] [--frames N] [--out docs/benchmarks]

DIR has bivme_guide_points/, which patient1 and sliced are made of. Every part takes minutes on two
cores and goes into beating.json as soon as it is measured, beside what is there; the page and its
plots are written from that.
"""

import argparse
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from benchmarks.beating.killed_run import killed_run
from benchmarks.beating.page import page
from benchmarks.beating.phantom_beats import phantom_beats
from benchmarks.beating.plots import draw
from benchmarks.beating.real_cycle import real_cycle
from benchmarks.beating.results import BeatingResults
from benchmarks.beating.sliced_cycle import sliced_cycle
from benchmarks.measure import ROOT
from benchmarks.results import Value

_OF_DATA: dict[str, Callable[[Path, int | None], Value]] = {
    "patient1": real_cycle,
    "sliced": sliced_cycle,
}
_BY_ITSELF: dict[str, Callable[[int | None], Value]] = {
    "phantom": phantom_beats,
    "killed": killed_run,
}
PARTS = [*_OF_DATA, *_BY_ITSELF]


def main() -> None:
    """Measure what was chosen, then write."""
    arguments = _arguments()
    folder: Path = arguments.out
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "beating.json"
    results = (
        BeatingResults.model_validate_json(file.read_bytes())
        if file.is_file()
        else BeatingResults()
    )
    for part, measured in ({} if arguments.render else _chosen(arguments)).items():
        began_s = time.monotonic()
        results = results.model_copy(update={part: measured()})
        file.write_text(results.model_dump_json(indent=1, exclude_none=False) + "\n")
        print(f"{part}: {time.monotonic() - began_s:.0f} s", file=sys.stderr, flush=True)
    plots = {name: plot.name for name, plot in draw(results, folder).items()}
    (folder / "beating.md").write_text(page(results, plots))


def _chosen(arguments: argparse.Namespace) -> dict[str, Callable[[], Value]]:
    """What measures each part that was asked for and can be measured."""
    data, frames = arguments.data, arguments.frames
    parts: dict[str, Callable[[], Value]] = {}
    for name in arguments.only or PARTS:
        if name in _BY_ITSELF:
            parts[name] = partial(_BY_ITSELF[name], frames)
        elif data is not None:
            parts[name] = partial(_OF_DATA[name], data, frames)
        else:
            print(f"{name}: left out, name its data with --data", file=sys.stderr)
    return parts


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.beating",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--data", type=Path, metavar="DIR", help="has bivme_guide_points/")
    parser.add_argument("--only", action="append", default=[], choices=PARTS)
    parser.add_argument("--frames", type=int, metavar="N", help="fewer, for a look")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "benchmarks", metavar="DIR")
    parser.add_argument("--render", action="store_true", help="page and plots from beating.json")
    return parser.parse_args()


if __name__ == "__main__":
    main()
