import sys
import time
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from cli.children import Children, python_module
from schemas.problem import InternalError

SLEEPS = [sys.executable, "-c", "import time; time.sleep(60)"]


@pytest.fixture
def children(tmp_path: Path) -> Iterator[Children]:
    children = Children(tmp_path / "logs")
    yield children
    children.stop()


def test_children_are_ended_the_last_started_first(children: Children, tmp_path: Path) -> None:
    diary = tmp_path / "diary"
    code = (
        "import signal, sys, time\n"
        f"def write(line): open({str(diary)!r}, 'a').write(line + '\\n')\n"
        "def end(*_): write(f'{sys.argv[1]} ends'); sys.exit()\n"
        "signal.signal(signal.SIGTERM, end)\n"
        "write('ready')\n"
        "time.sleep(60)"
    )
    for name in ("first", "second", "third"):
        children.start(name, [sys.executable, "-c", code, name])
    deadline = time.monotonic() + 20.0
    while not (diary.exists() and diary.read_text().count("ready") == 3):
        assert time.monotonic() < deadline
        time.sleep(0.02)
    children.check()

    children.stop()

    assert diary.read_text().split("\n")[3:-1] == ["third ends", "second ends", "first ends"]


def test_a_child_that_ended_is_reported_with_its_last_words(children: Children) -> None:
    children.start("clock", SLEEPS)
    process = children.start("broken", [sys.executable, "-c", "raise SystemExit('no luck')"])
    process.wait(timeout=20)
    with pytest.raises(InternalError, match="broken ended by itself with code 1") as told:
        children.check()
    assert "no luck" in told.value.detail
    assert "broken.log" in told.value.detail


def test_a_child_that_somebody_dealt_with_is_not_reported(children: Children) -> None:
    process = children.start("broken", [sys.executable, "-c", ""])
    process.wait(timeout=20)
    children.forget_ended()
    children.check()


def test_a_child_reads_what_it_is_given(children: Children, tmp_path: Path) -> None:
    command = [sys.executable, "-c", "print('read', input())"]
    children.start("reader", command, stdin="a secret\n").wait(timeout=20)
    assert (tmp_path / "logs" / "reader.log").read_text() == "read a secret\n"


def test_a_child_that_does_not_listen_is_killed_with_its_own_children(
    children: Children, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("cli.children._STOPS_WITHIN_S", 0.5)
    code = (
        "import signal, subprocess, sys, time; signal.signal(signal.SIGTERM, signal.SIG_IGN);"
        f"p = subprocess.Popen({SLEEPS!r}); print(p.pid, flush=True); time.sleep(60)"
    )
    process = children.start("deaf", [sys.executable, "-c", code])
    log = tmp_path / "logs" / "deaf.log"
    deadline = time.monotonic() + 20.0
    while not log.read_text().endswith("\n"):
        assert time.monotonic() < deadline
        time.sleep(0.02)
    grandchild = psutil.Process(int(log.read_text()))

    children.stop()

    assert process.returncode == -9
    while grandchild.is_running() and grandchild.status() != psutil.STATUS_ZOMBIE:
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_a_module_is_run_from_the_environment_not_from_the_working_folder(
    children: Children, tmp_path: Path
) -> None:
    (tmp_path / "logs" / "platform.py").write_text("raise SystemExit('the wrong one')")
    assert children.start("platform", python_module("platform")).wait(timeout=20) == 0
