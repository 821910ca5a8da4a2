"""One method on one study in a fresh process of its own: what it finds and what it costs.

A child loads the method's libraries, notes its memory, and runs it once. Its peak is the high-water
mark that Linux keeps of the child's own memory (`VmHWM`): `ru_maxrss` carries over the parent's.
"""

import importlib
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.found import Found, load, save
from schemas.study import ContourStudy
from worker.threads import bind_libraries

ROOT = Path(__file__).parents[1]

TIMEOUT_S = 900.0
"""A method that takes longer has failed."""

_ONE_THREAD = {"ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS": "1", "IGL_NUM_THREADS": "1"}
"""Libraries that `bind_libraries` does not know of, and that take all cores unless told."""


@dataclass(frozen=True)
class Cost:
    """What a method took, from the study to all its surfaces, on one thread.

    wall_s, cpu_s: without the start of the process and the import of libraries. peak_mib: resident
    memory of the whole process at its highest; libraries_mib: what it was before the method began.
    """

    wall_s: float
    cpu_s: float
    peak_mib: float
    libraries_mib: float


@dataclass(frozen=True, eq=False)
class Measured:
    """A method that came to its end."""

    found: Found
    cost: Cost


@dataclass(frozen=True)
class Failed:
    """A method that did not, and why."""

    reason: str


def measured(entry: str, study: ContourStudy, timeout_s: float = TIMEOUT_S) -> Measured | Failed:
    """Run `module:function` on a study in a fresh, single-threaded process."""
    bind_libraries(1)
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "study.json").write_text(study.model_dump_json())
        try:
            ended = subprocess.run(
                [sys.executable, "-m", "benchmarks.measure", entry, name],
                cwd=ROOT,
                capture_output=True,
                text=True,
                env={**os.environ, **_ONE_THREAD},
                timeout=timeout_s,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return Failed(f"not done after {timeout_s:g} s")
        if ended.returncode:
            last = ended.stderr.strip().rpartition("\n")[2]
            # Where this checkout lies is nobody's business.
            reason = last.replace(f"{ROOT}/", "")
            return Failed(reason or f"ended with status {ended.returncode}")
        cost = Cost(**json.loads((folder / "cost.json").read_text()))
        return Measured(load(folder / "found.npz"), cost)


def main(entry: str, folder: Path) -> None:
    """What the child does."""
    compute = _loaded(entry)
    study = ContourStudy.model_validate_json((folder / "study.json").read_bytes())
    libraries_mib = _memory_mib("VmRSS")
    wall, cpu = time.perf_counter(), time.process_time()
    found = compute(study)
    wall_s, cpu_s = time.perf_counter() - wall, time.process_time() - cpu
    cost = Cost(wall_s, cpu_s, _memory_mib("VmHWM"), libraries_mib)
    save(found, folder / "found.npz")
    (folder / "cost.json").write_text(json.dumps(asdict(cost)))


def _loaded(entry: str) -> Callable[[ContourStudy], Found]:
    module, _, function = entry.partition(":")
    compute: Callable[[ContourStudy], Found] = getattr(importlib.import_module(module), function)
    return compute


def _memory_mib(line: str) -> float:
    status = Path("/proc/self/status").read_text()
    found = re.search(rf"^{line}:\s*(\d+) kB$", status, re.MULTILINE)
    if found is None:
        raise RuntimeError(f"/proc/self/status says no {line}; run the benchmark on Linux")
    return int(found[1]) / 1024.0


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
