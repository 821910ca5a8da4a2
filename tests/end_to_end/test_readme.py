"""The README's transcripts, typed into a real shell beside a real server (see `transcript.py`).

A new user's way: README.md's `console` blocks must work as they stand. They run in a folder of
their own in which `examples/` is the repository's.
"""

import os
import subprocess
import sysconfig
from pathlib import Path

import pytest

from tests.end_to_end.serve_process import ServeProcess
from tests.end_to_end.transcript import SERVER, matches, script, steps

pytestmark = [pytest.mark.integration, pytest.mark.slow]

ROOT = Path(__file__).parents[2]
MARKER = "=-=-= next command =-=-="


def test_the_readme_can_be_typed_in(server: ServeProcess, tmp_path: Path) -> None:
    told = steps((ROOT / "README.md").read_text(encoding="utf-8"))
    assert told, "README.md has no ```console block"
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    here = server.url.removeprefix("http://")

    ended = subprocess.run(
        ["bash", "-c", script([s.command.replace(SERVER, here) for s in told], MARKER)],
        cwd=tmp_path,
        env={
            **os.environ,
            "PATH": f"{sysconfig.get_path('scripts')}{os.pathsep}{os.environ['PATH']}",
            "NEURALMRI_URL": server.url,
            "COLUMNS": "100",
        },
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
