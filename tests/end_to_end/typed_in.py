"""A document's transcripts and programs, run for real beside a server (see `transcript.py`)."""

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

from tests.end_to_end.serve_process import ServeProcess
from tests.end_to_end.transcript import SERVER, matches, programs, script, steps

ROOT = Path(__file__).parents[2]
MARKER = "=-=-= next command =-=-="


def type_in(document: Path, server: ServeProcess, folder: Path) -> None:
    """Type a document's `console` blocks into one shell, in a folder where `examples/` is."""
    told = steps(document.read_text(encoding="utf-8"))
    assert told, f"{document.name} has no ```console block"
    _give_examples(folder)
    here = server.url.removeprefix("http://")

    ended = subprocess.run(
        ["bash", "-c", script([s.command.replace(SERVER, here) for s in told], MARKER)],
        cwd=folder,
        env=_environment(server),
        capture_output=True,
        text=True,
        timeout=500,
        check=False,
    )

    printed = ended.stdout.replace(here, SERVER).split(f"{MARKER}\n")[1:]
    for step, output in zip(told, printed, strict=False):
        assert matches(step.expected, output), f"$ {step.command}\n{output}{ended.stderr}"
    assert ended.returncode == 0, f"$ {told[len(printed) - 1].command}\n{ended.stderr}"
    assert len(printed) == len(told)


def run_program(document: Path, number: int, server: ServeProcess, folder: Path) -> str:
    """Run a document's Python block, counted from 0, where `examples/` is. What it printed."""
    (folder / "program.py").write_text(programs(document.read_text(encoding="utf-8"))[number])
    _give_examples(folder)
    ended = subprocess.run(
        [sys.executable, "-W", "error", "program.py"],
        cwd=folder,
        env=_environment(server),
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def _give_examples(folder: Path) -> None:
    (folder / "examples").symlink_to(ROOT / "examples")


def _environment(server: ServeProcess) -> dict[str, str]:
    return {
        **os.environ,
        "PATH": f"{sysconfig.get_path('scripts')}{os.pathsep}{os.environ['PATH']}",
        "NEURALMRI_URL": server.url,
        "COLUMNS": "100",
    }
