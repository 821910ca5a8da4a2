"""A process gives way by as much as it is told; a session where the kernel has it."""

import subprocess
import sys
from pathlib import Path

from worker.niceness import let_session_give_way


def test_a_process_and_what_it_starts_are_nicer_by_as_much() -> None:
    code = (
        "import os, subprocess; from worker.niceness import give_way; before = os.nice(0);"
        "give_way(3); print(os.nice(0) - before);"
        "print(int(subprocess.check_output(['nice'])) - before)"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ended.stdout.split() in (["3", "3"], ["0", "0"])  # as nice as can be already


def test_the_session_is_as_nice_where_there_is_such_a_thing(tmp_path: Path) -> None:
    autogroup = tmp_path / "autogroup"
    let_session_give_way(5, autogroup)
    assert not autogroup.exists()
    autogroup.write_text("/autogroup-1 nice 0\n")
    let_session_give_way(5, autogroup)
    assert autogroup.read_text() == "5"


def test_a_kernel_that_refuses_costs_nothing(tmp_path: Path) -> None:
    let_session_give_way(5, tmp_path)  # a folder takes no text
