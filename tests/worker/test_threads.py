import os
import subprocess
import sys

import pytest

SAYS = """
from worker.threads import bind_libraries, use_threads
bind_libraries({count})
use_threads({count})
import os, torch
print(torch.get_num_threads(), os.environ["OPENBLAS_NUM_THREADS"])
"""


@pytest.mark.parametrize("count", [1, 2])
def test_torch_and_the_libraries_use_what_was_said(count: int) -> None:
    said = subprocess.run(
        [sys.executable, "-c", SAYS.format(count=count)],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "OMP_NUM_THREADS": "7"},
    ).stdout
    assert said.split() == [str(count), str(count)]
