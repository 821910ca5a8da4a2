"""A job's folder: the durable truth about one job, wherever it is kept.

Every step is one that a reader sees whole or not at all. No step makes a missing job: a worker that
still runs after an erasure gets `JobGone`, and cannot resurrect the job. Any step may raise
StoreUnavailable where the folders are not on a disk of this machine.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO, Protocol, runtime_checkable

from jobs.stored_file import StoredFile
from jobs.stored_input import StoredInput, StoredObject
from schemas.artifacts import Manifest
from schemas.messages import JobRequest, Outcome

Source = Path | bytes | BinaryIO | StoredInput | StoredObject
"""An input to copy: a file by path, its bytes, an open file that is read from its start, or what
another job has."""

_FILE_NAME = re.compile(r"^[A-Za-z0-9_][A-Za-z0-9._-]{0,159}$")


@runtime_checkable
class JobFolder(Protocol):
    """The folder of one job, whether or not it is there yet."""

    job_id: str

    def create(self, request: JobRequest, inputs: Mapping[str, Source]) -> None:
        """Keep request and inputs, durably, and show the job in one step.

        `inputs` maps a file name to what to copy. A crash leaves no half job, only what the store
        sweeps. Raises FileExistsError where the job exists.
        """

    def exists(self) -> bool: ...

    def request(self) -> JobRequest:
        """What was asked. Raises JobGone."""

    def owner(self) -> str:
        """Whose job it is. Raises JobGone."""

    def stored_input(self, name: str) -> StoredInput | StoredObject:
        """An input, to be given to another job. Raises JobGone, also for what was never one."""

    def local_input(self, name: str, staging: Path) -> Path:
        """A file of this machine with the input, there as long as the attempt's `staging`.

        It is not to be changed. Raises JobGone, also for a name that was never an input.
        """

    def staging(self, token: int) -> Path:
        """A fresh private folder for the results of the attempt that holds `token`.

        Raises JobGone.
        """

    def drop_staging(self, staging: Path) -> None:
        """Remove a staging folder, where it has not become the results."""

    def publish(self, staging: Path, manifest: Manifest) -> None:
        """Make a staging folder the job's results. The first publisher wins.

        Raises AlreadyPublished, JobGone, or ValueError where the staging folder does not hold what
        the manifest says. After StoreUnavailable it may be asked again.
        """

    def tidy(self) -> None:
        """Remove what the attempts on an ended job left beside its results."""

    def manifest(self) -> Manifest | None:
        """What was published; None before, or where the job is gone."""

    def artifact(self, name: str) -> StoredFile:
        """A published file, `manifest.json` too.

        Raises KeyError for a name not in the manifest, JobGone where it was erased meanwhile.
        """

    def write_outcome(self, outcome: Outcome) -> Outcome:
        """Say how the job ended, once, and return the outcome that stands.

        The first writer wins: a later one gets the first one's outcome back, and should record
        that. Raises JobGone.
        """

    def outcome(self) -> Outcome | None:
        """How the job ended; None before, or where the job is gone."""

    def read_checkpoint(self, name: str) -> bytes | None:
        """What an attempt left under a name; None where it left nothing."""

    def write_checkpoint(self, name: str, content: bytes) -> None:
        """Leave something for a later attempt, unless the job has ended. Raises JobGone, OSError.

        Content must follow from the job alone: an attempt that was overtaken may write last.
        """

    def drop_checkpoints(self) -> None:
        """Remove what attempts left: the job has ended."""

    def mark_announced(self) -> None:
        """Note that the job's end is in the webhooks' outbox. Idempotent; raises JobGone."""

    def is_announced(self) -> bool: ...

    def erase(self) -> None:
        """Remove everything. From one instant on the job is gone; the rest frees space."""


def checked(name: str) -> str:
    """The name, if it is a plain file name. Raises ValueError."""
    if not _FILE_NAME.fullmatch(name):
        raise ValueError(f"not a plain file name: {name!r}")
    return name


def check_staged(staging: Path, manifest: Manifest) -> None:
    """Raise ValueError where the folder does not hold what the manifest says."""
    for artifact in manifest.artifacts:
        try:
            held = (staging / checked(artifact.name)).stat().st_size
        except FileNotFoundError as error:
            raise ValueError(f"the manifest names a file that is missing: {error}") from error
        if held != artifact.bytes:
            raise ValueError(
                f"{artifact.name} has {held} bytes, not {artifact.bytes} as in the manifest"
            )
