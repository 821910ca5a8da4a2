"""The machine and the libraries that a run depends on."""

import os
import platform
import re
from importlib.metadata import version
from pathlib import Path

from benchmarks.results import Environment
from worker.cores import usable_cores

_LIBRARIES = ("neuralmri", "libigl", "numpy", "scikit-image", "scipy", "torch")


def environment() -> Environment:
    """What to say about where the numbers come from."""
    model = re.search(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30
    return Environment(
        cpu=model[1] if model else platform.machine(),
        cores=usable_cores(),
        threads=1,
        memory_gib=round(memory, 1),
        load=round(os.getloadavg()[0], 2),
        system=f"{platform.system()} {platform.machine()}",
        python=platform.python_version(),
        libraries={name: version(name) for name in _LIBRARIES},
    )
