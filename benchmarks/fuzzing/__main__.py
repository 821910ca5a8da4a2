"""A long run of every kind of fuzzing, and a table of what came back.

    python -m benchmarks.fuzzing [--examples N] [--seed S] [--only api contours labels]

Exits with 1 where the service, its description or its worker did what it must not.
"""

import argparse
import sys
import tempfile
from pathlib import Path

from benchmarks.fuzzing.answers_by_operation import table
from benchmarks.fuzzing.barrage import Tally, barrage
from benchmarks.fuzzing.contour_uploads import contour_uploads
from benchmarks.fuzzing.described import SETTINGS, run_schemathesis
from benchmarks.fuzzing.label_uploads import label_uploads
from benchmarks.fuzzing.running_service import RunningService, running_service
from benchmarks.fuzzing.science import Science
from worker.threads import bind_libraries

_PARTS = ("api", "contours", "labels")
_SCIENCE_EVERY = 5
"""Of what was accepted, every fifth is computed."""


def main() -> None:
    """Fuzz, print, and exit with 1 where anything was found."""
    arguments = _arguments()
    bind_libraries(1)
    is_clean = True
    with (
        tempfile.TemporaryDirectory(prefix="fuzzing-") as folder,
        running_service(Path(folder) / "data", SETTINGS) as service,
    ):
        if "contours" in arguments.only:
            _uploads("contours", service, arguments)
        if "labels" in arguments.only:
            _uploads("labels", service, arguments)
        if "api" in arguments.only:
            is_clean = _api(service, Path(folder), arguments)
        print(f"\nPeak memory of the service: {service.peak_memory_bytes() >> 20} MiB")
    sys.exit(0 if is_clean else 1)


def _api(service: RunningService, folder: Path, arguments: argparse.Namespace) -> bool:
    found = run_schemathesis(service, folder, examples=arguments.examples, seed=arguments.seed)
    print(f"\n## api: {found.generated} requests in {found.seconds:.0f} s\n")
    print(table(found.answers))
    for failure in (*found.failures, *found.untested):
        print(f"- {failure}")
    if not found.is_clean:
        print(found.transcript)
    return found.is_clean


def _uploads(kind: str, service: RunningService, arguments: argparse.Namespace) -> None:
    science = Science(_SCIENCE_EVERY)
    uploads = contour_uploads() if kind == "contours" else label_uploads()
    tally = barrage(
        service, uploads, examples=arguments.examples, start=arguments.seed, accepted=science
    )
    print(f"\n## {kind}: {tally.sent} uploads, the slowest answer after {tally.slowest_s:.1f} s\n")
    print(tally_table(tally, science))


def tally_table(tally: Tally, science: Science) -> str:
    """Markdown: how often each answer came, and how the accepted ones ended that were run."""
    rows = [("answer", "times"), ("---", "---"), *tally.answers.most_common()]
    rows += [(f"run: {outcome}", times) for outcome, times in science.outcomes.most_common()]
    return "\n".join(f"| {name} | {times} |" for name, times in rows)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzzing", description=__doc__)
    parser.add_argument(
        "--examples", type=int, default=1000, help="uploads of each kind; requests an operation"
    )
    parser.add_argument("--seed", type=int, default=1, help="the same seed, the same requests")
    parser.add_argument("--only", nargs="+", default=list(_PARTS), choices=_PARTS)
    return parser.parse_args()


if __name__ == "__main__":
    main()
