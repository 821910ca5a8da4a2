import os
import subprocess
import sys
import time

import psutil
import pytest

PARENT = """
import os, subprocess, sys
code = (
    "import os, sys, time; from worker.parent_death import die_with_parent; "
    "die_with_parent(int(sys.argv[1])); print('armed', os.getpid(), flush=True); time.sleep(60)"
)
subprocess.run([sys.executable, "-c", code, str({parent})])
"""


def start(parent: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-c", PARENT.format(parent=parent)],
        stdout=subprocess.PIPE,
        text=True,
        cwd=os.getcwd(),
    )


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="prctl is Linux's")
def test_a_child_ends_with_a_parent_that_was_killed() -> None:
    parent = start("os.getpid()")
    assert parent.stdout is not None
    with parent.stdout:
        said, pid = parent.stdout.readline().split()
        assert said == "armed"
        child = psutil.Process(int(pid))

        parent.kill()
        parent.wait()

        deadline = time.monotonic() + 5.0
        while child.is_running() and child.status() != psutil.STATUS_ZOMBIE:
            assert time.monotonic() < deadline
            time.sleep(0.02)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="prctl is Linux's")
def test_a_child_that_is_orphaned_already_ends_itself() -> None:
    parent = start("1")
    output, _ = parent.communicate(timeout=20)
    assert output == ""
