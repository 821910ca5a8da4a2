"""One subject from its study to all files, as `neuralmri reconstruct` does it, and what that costs.

    python -m benchmarks.beating.real_run FOLDER PROCESSES

FOLDER has request.json; the files go to FOLDER/out, the costs to FOLDER/costs.json.
"""

import json
import logging
import resource
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.beating.cpu_clock import CpuClock
from benchmarks.measure import ROOT
from schemas.job import Stage
from schemas.messages import ContourRequest
from schemas.report import Report
from worker.threads import bind_libraries

_WITHIN_S = 1800.0


@dataclass(frozen=True)
class Costs:
    """Without the start of Python and the import of libraries."""

    wall_s: float
    cpu_s: float
    peak_mib: float
    fit_cpu_s: dict[str, float]


@dataclass(frozen=True)
class RealRun:
    """process_s: of the whole process."""

    report: Report
    costs: Costs
    process_s: float


def real_run(request: ContourRequest, processes: int) -> RealRun:
    """In a fresh process and its helpers, one thread each. CalledProcessError where it fails."""
    bind_libraries(1)
    with TemporaryDirectory(prefix="beating-") as name:
        folder = Path(name)
        (folder / "request.json").write_text(request.model_dump_json())
        began_s = time.perf_counter()
        subprocess.run(
            [sys.executable, "-m", "benchmarks.beating.real_run", name, str(processes)],
            cwd=ROOT,
            timeout=_WITHIN_S,
            check=True,
        )
        process_s = time.perf_counter() - began_s
        costs = Costs(**json.loads((folder / "costs.json").read_bytes()))
        report = Report.model_validate_json((folder / "out" / "report.json").read_bytes())
    return RealRun(report, costs, process_s)


class _Raises(logging.Handler):
    def emit(self, record: logging.LogRecord) -> None:
        raise RuntimeError(record.getMessage())


def main(folder: Path, processes: int) -> None:
    """What the child does."""
    from worker.subject import run
    from worker.threads import use_threads

    request = ContourRequest.model_validate_json((folder / "request.json").read_bytes())
    (folder / "out").mkdir()
    # A helper that is lost is made up for, and said in the log alone: no figures come of that.
    logging.getLogger("worker.helped_crew").addHandler(_Raises())
    use_threads(1)  # loads what takes seconds to load
    clock = CpuClock()
    began_s = time.perf_counter()
    run(
        request.study,
        request.options,
        folder / "out",
        threads=1,
        processes=processes,
        input_sha256="0" * 64,
        warnings=request.warnings,
        observer=clock,
    )
    costs = Costs(
        wall_s=time.perf_counter() - began_s,
        cpu_s=clock.total_s(),
        peak_mib=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        fit_cpu_s=clock.by_frame_s(Stage.FITTING),
    )
    (folder / "costs.json").write_text(json.dumps(asdict(costs)))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
