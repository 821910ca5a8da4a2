"""Where folders go that lie among the jobs and are none: out of the way, and never deleted.

    <data folder>/quarantine/<name>-<instant>/<name>    as it was found
                                              why.json  for whoever looks

Put back by moving it to where it was; taken for good by deleting it. Both are a person's to do.
"""

import contextlib
import json
from datetime import UTC, datetime
from pathlib import Path

from jobs.durable import sync_folder, write_durably

_LONGEST_NAME = 100


class Quarantine:
    """Beside the folder of job folders, on its file system."""

    def __init__(self, jobs_root: Path) -> None:
        self.root = jobs_root.parent / "quarantine"

    def take(self, found: Path, why: str) -> Path | None:
        """Move a folder here with the reason, and return where it is.

        None where it is gone: erased, or another process has taken it. Raises OSError.
        """
        now = datetime.now(tz=UTC)
        self.root.mkdir(mode=0o700, exist_ok=True)
        place = self.root / f"{found.name[:_LONGEST_NAME]}-{now:%Y%m%dT%H%M%S.%fZ}"
        place.mkdir(mode=0o700)
        note = {
            "name": found.name,
            "found_in": str(found.parent),
            "at": f"{now:%FT%TZ}",
            "why": why,
        }
        try:
            write_durably(place / "why.json", json.dumps(note, indent=1).encode() + b"\n")
            found.rename(place / found.name)
        except BaseException as error:
            with contextlib.suppress(OSError):  # the one that matters is on its way
                (place / "why.json").unlink(missing_ok=True)
                place.rmdir()
            if isinstance(error, FileNotFoundError):
                return None
            raise
        for folder in (place, self.root, found.parent):
            sync_folder(folder)
        return place

    def count(self) -> int:
        """How many there are. Raises OSError."""
        try:
            return sum(1 for _ in self.root.iterdir())
        except FileNotFoundError:
            return 0
