"""Checkpoints of a job that is not finished: files in its folder that may vanish at any time.

They are no results, and nothing depends on them: each is written whole or not at all, any attempt
may put its own in place of another's, and all go when the job ends.
"""

import os
import shutil
from pathlib import Path

from jobs.durable import sync_folder, write_durably

_FOLDER = "checkpoints"
_DROPPED = "staging-checkpoints-"
"""Where they are moved to be removed: whatever begins with `staging-` is swept at the job's end."""


def read_checkpoint(job: Path, name: str) -> bytes | None:
    """The content, None where there is none. Raises OSError where the disk fails."""
    try:
        return (job / _FOLDER / name).read_bytes()
    except FileNotFoundError:
        return None


def write_checkpoint(job: Path, name: str, content: bytes) -> None:
    """Put the content in place of what was there, in one rename.

    Nothing is written to a job that has ended. Raises FileNotFoundError where the job has no folder
    or dropped its checkpoints this instant, and OSError as the disk does.
    """
    folder = job / _FOLDER
    folder.mkdir(exist_ok=True)
    if (job / "outcome.json").exists():
        # Looked for after the folder was made: who ends the job writes first and drops then.
        drop_checkpoints(job)
        return
    draft = folder / f".{os.getpid()}-{os.urandom(6).hex()}"
    try:
        write_durably(draft, content)
        draft.replace(folder / name)
    finally:
        draft.unlink(missing_ok=True)
    sync_folder(folder)


def drop_checkpoints(job: Path) -> None:
    """Remove all of them. Nothing happens where there are none."""
    grave = job / f"{_DROPPED}{os.urandom(6).hex()}"
    try:
        # First out of the way of whoever still writes.
        (job / _FOLDER).rename(grave)
    except FileNotFoundError:
        return
    shutil.rmtree(grave, ignore_errors=True)
