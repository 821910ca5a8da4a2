"""All job folders of one installation, and the ids that name them."""

import re
import secrets
import threading
import time
from collections.abc import Collection
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from jobs.folder import JobFolder

JOB_ID_PATTERN = r"^[0-9a-f]{32}$"

_JOB_ID = re.compile(JOB_ID_PATTERN)


def is_job_id(text: str) -> bool:
    """Whether the text may name a job: to be asked before it touches a path."""
    return _JOB_ID.fullmatch(text) is not None


def checked_job_id(text: str) -> str:
    """The id. Raises ValueError for what cannot be one."""
    if not is_job_id(text):
        raise ValueError("not a job id: 32 hexadecimal digits are")
    return text


def made_at_s(job_id: str) -> float:
    """When the id was made, Unix time."""
    return int(job_id[:12], 16) / 1000


class JobIds:
    """Makes ids: 48 bits of Unix time in ms, then 80 random bits, as 32 hex digits.

    Within one process each is larger than the one before.
    """

    def __init__(self) -> None:
        self._last = 0
        self._lock = threading.Lock()

    def new(self) -> str:
        drawn = (time.time_ns() // 1_000_000) << 80 | secrets.randbits(80)
        with self._lock:
            self._last = max(drawn, self._last + 1)
            return f"{self._last:032x}"


@dataclass(frozen=True)
class Space:
    """Room of the file system that the store is on."""

    total_bytes: int
    free_bytes: int


@runtime_checkable
class JobStore(Protocol):
    """Where job folders are kept. Any step may raise StoreUnavailable, save `trouble`."""

    def new_id(self) -> str:
        """A job id that nothing has."""

    def folder(self, job_id: str) -> JobFolder:
        """The folder of a job. Raises ValueError for what cannot be a job id."""

    def ids(self) -> list[str]:
        """Ids of every job that has a folder, oldest first."""

    def gone(self, job_ids: Collection[str]) -> set[str]:
        """Those of the ids that no job has, or none any more."""

    def set_aside(self, suspects: Collection[str]) -> tuple[str, ...]:
        """Put into quarantine what lies among the jobs and is none, and return its names.

        That is what has no job's name, and of `suspects`, ids of jobs, those that are damaged. One
        that is sound stays, and one whose form is only unknown to this release. Nothing is deleted.
        """

    def quarantined(self) -> int:
        """How many there are. Raises OSError or StoreUnavailable."""

    def prove(self) -> None:
        """Raise StoreMisfit where this store could never keep a job: asked once, at start.

        One that does not answer just now is no misfit.
        """

    def trouble(self) -> str | None:
        """Why nothing can be written here now; None where it can."""

    def space(self) -> Space | None:
        """How much room there is; None where that has no bound.

        Raises OSError or StoreUnavailable where it cannot be asked.
        """

    def sweep(self) -> None:
        """Remove what a crash left: erasures half done, and submissions that were never shown."""
