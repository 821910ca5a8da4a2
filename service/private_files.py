"""Files in the data folder that several processes, and perhaps root, write: private, and owned by
whom the folder belongs to.
"""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PRIVATE = 0o600


@contextmanager
def held(lock: Path) -> Iterator[None]:
    """Hold a lock file, made where it is missing, until the block ends."""
    descriptor = open_private(lock, os.O_RDWR)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def open_private(path: Path, flags: int) -> int:
    """A descriptor of a file that is made where it is missing, for its owner's eyes only."""
    descriptor = os.open(path, flags | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, PRIVATE)
    give_to_owner_of(path.parent, path)
    return descriptor


def give_to_owner_of(folder: Path, path: Path) -> None:
    """Root may make files for a service that runs as somebody else."""
    if os.geteuid() == 0:
        owner = folder.stat()
        os.chown(path, owner.st_uid, owner.st_gid, follow_symlinks=False)
