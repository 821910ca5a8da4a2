"""An input that another job has stored: shared on a disk, copied within a bucket."""

import errno
import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from jobs.errors import JobGone

_NO_LINKS = (errno.EXDEV, errno.EPERM, errno.EACCES, errno.EMLINK, errno.EOPNOTSUPP, errno.ENOSYS)
"""A file system, or two of them, on which a file cannot have a second name."""


@dataclass(frozen=True)
class StoredInput:
    """A file in a job's `inputs`. It is never written again, so two jobs may share its bytes.

    Each has a name of its own for them; erasing one job leaves the other's.
    """

    path: Path

    def give(self, target: Path) -> None:
        """Let `target` be the same content. Raises JobGone where the job was erased meanwhile."""
        try:
            os.link(self.path, target)
        except FileNotFoundError as error:
            raise JobGone(f"{self.path.name} was erased") from error
        except OSError as error:
            if error.errno not in _NO_LINKS:
                raise
            shutil.copyfile(self.path, target)


@dataclass(frozen=True)
class StoredObject:
    """An object of a job's inputs, by its key in the bucket. It is never written again."""

    key: str
    open: Callable[[], BinaryIO]
