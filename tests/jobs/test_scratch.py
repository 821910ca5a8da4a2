"""Folders of this machine that outlive no process."""

import subprocess
import sys
from pathlib import Path

from jobs.scratch import Scratch


def test_folders_in_use_are_left_alone_also_by_others(tmp_path: Path) -> None:
    one, other = Scratch(tmp_path), Scratch(tmp_path)
    kept, dropped = one.folder(), one.folder()
    (dropped / "sax.nii").write_bytes(b"voxels")
    one.drop(dropped)
    one.drop(dropped)
    mine = other.folder()
    assert {path for path in tmp_path.iterdir() if path.is_dir()} == {kept, mine}


def test_what_a_killed_process_left_is_removed(tmp_path: Path) -> None:
    program = (
        "import os, sys, pathlib; from jobs.scratch import Scratch\n"
        "folder = Scratch(pathlib.Path(sys.argv[1])).folder()\n"
        "(folder / 'sax.nii').write_bytes(b'voxels')\n"
        "os.kill(os.getpid(), 9)"
    )
    ended = subprocess.run([sys.executable, "-c", program, str(tmp_path)], check=False)
    assert ended.returncode == -9
    assert [path for path in tmp_path.iterdir() if path.is_dir()]
    Scratch(tmp_path)
    assert not [path for path in tmp_path.iterdir() if path.is_dir()]


def test_only_its_owner_may_look(tmp_path: Path) -> None:
    scratch = Scratch(tmp_path / "new" / "scratch")
    for path in (tmp_path / "new" / "scratch", scratch.folder()):
        assert path.stat().st_mode & 0o077 == 0
