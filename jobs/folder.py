"""A job's folder: the durable truth about one job.

    <root>/<job id>/request.json        what to do; there from the first instant
                    inputs/<name>       uploaded files
                    checkpoints/        how far attempts came, while it is not finished
                    staging-*/          one attempt's results while they are written
                    results/            the published results, manifest.json among them
                    outcome.json        how the job ended, once it has
                    announced           its end is in the webhooks' outbox (the service's mark)

Every step is a rename or a link, so a reader sees all of it or nothing. No step makes a missing job
folder: a worker that still runs after an erasure gets `JobGone`, and cannot resurrect the job.
"""

import contextlib
import os
import re
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO

from jobs import checkpoint_files
from jobs.durable import sync_folder, sync_tree, write_durably
from jobs.errors import AlreadyPublished, JobGone
from jobs.stored_input import StoredInput
from schemas.artifacts import MANIFEST_NAME, Manifest
from schemas.messages import JobOwner, JobRequest, Outcome

NEW_PREFIX = ".new-"
ERASED_PREFIX = ".erased-"

Source = Path | bytes | BinaryIO | StoredInput
"""An input to copy: a file by path, its bytes, an open file that is read from its start, or what
another job has."""

_FILE_NAME = re.compile(r"^[A-Za-z0-9_][A-Za-z0-9._-]{0,159}$")


class JobFolder:
    """The folder of one job under `root`, whether or not it is there yet."""

    def __init__(self, root: Path, job_id: str) -> None:
        self.job_id = job_id
        self.path = root / job_id
        self._root = root

    def create(self, request: JobRequest, inputs: Mapping[str, Source]) -> None:
        """Write request and inputs, fsynced, and show the folder in one rename.

        `inputs` maps a file name to what to copy. A crash leaves no half job, only a hidden
        folder that the store sweeps. Raises FileExistsError where the job exists.
        """
        new = Path(tempfile.mkdtemp(prefix=NEW_PREFIX, dir=self._root))
        try:
            folder = new / "inputs"
            folder.mkdir()
            for name, source in inputs.items():
                _copy(source, folder / _checked(name))
            (new / "request.json").write_text(request.model_dump_json(), encoding="utf-8")
            sync_tree(new)
            if self.path.exists():
                raise FileExistsError(f"job {self.job_id} has a folder already")
            new.rename(self.path)
        except BaseException:
            shutil.rmtree(new)
            raise
        sync_folder(self._root)

    def exists(self) -> bool:
        return (self.path / "request.json").is_file()

    def request(self) -> JobRequest:
        """What was asked. Raises JobGone."""
        return JobRequest.model_validate_json(self._read("request.json"))

    def owner(self) -> str:
        """Whose job it is. Raises JobGone."""
        return JobOwner.model_validate_json(self._read("request.json")).owner

    def input_path(self, name: str) -> Path:
        """Where an input lies. Raises JobGone, also for a name that was never an input."""
        path = self.path / "inputs" / _checked(name)
        if not path.is_file():
            raise JobGone(f"job {self.job_id} has no input {name}")
        return path

    def staging(self, token: int) -> Path:
        """A fresh private folder for the results of the attempt that holds `token`."""
        try:
            return Path(tempfile.mkdtemp(prefix=f"staging-{token}-", dir=self.path))
        except FileNotFoundError as error:
            raise JobGone(f"job {self.job_id} has no folder") from error

    def publish(self, staging: Path, manifest: Manifest) -> None:
        """Make a staging folder the job's results. The first publisher wins.

        Raises AlreadyPublished, JobGone, or ValueError where the staging folder does not hold what
        the manifest says.
        """
        try:
            for artifact in manifest.artifacts:
                held = (staging / _checked(artifact.name)).stat().st_size
                if held != artifact.bytes:
                    raise ValueError(
                        f"{artifact.name} has {held} bytes, not {artifact.bytes} as in the manifest"
                    )
            write_durably(staging / MANIFEST_NAME, manifest.model_dump_json(indent=1).encode())
            sync_tree(staging)
            # A rename onto a folder that is not empty fails, and results/ is never empty.
            staging.rename(self.path / "results")
        except FileNotFoundError as error:
            if self.exists():
                raise ValueError(f"the manifest names a file that is missing: {error}") from error
            raise JobGone(f"job {self.job_id} was erased") from error
        except OSError as error:
            if (self.path / "results").is_dir():
                raise AlreadyPublished(f"job {self.job_id} has results already") from error
            raise
        sync_folder(self.path)

    def manifest(self) -> Manifest | None:
        """What was published; None before, or where the job is gone."""
        try:
            return Manifest.model_validate_json(self._read(f"results/{MANIFEST_NAME}"))
        except JobGone:
            return None

    def manifest_path(self) -> Path:
        return self.path / "results" / MANIFEST_NAME

    def artifact_path(self, name: str) -> Path:
        """Where a published artifact lies. Raises KeyError for a name not in the manifest."""
        manifest = self.manifest()
        for artifact in manifest.artifacts if manifest else ():
            if artifact.name == name:
                return self.path / "results" / artifact.name
        raise KeyError(name)

    def write_outcome(self, outcome: Outcome) -> Outcome:
        """Say how the job ended, once, and return the outcome that stands.

        The first writer wins: a later one gets the first one's outcome back, and should record
        that. Raises JobGone.
        """
        draft = self.path / f".outcome-{os.getpid()}-{os.urandom(6).hex()}"
        try:
            write_durably(draft, outcome.model_dump_json().encode())
            os.link(draft, self.path / "outcome.json")
            sync_folder(self.path)
        except FileExistsError:
            return Outcome.model_validate_json(self._read("outcome.json"))
        except FileNotFoundError as error:
            raise JobGone(f"job {self.job_id} was erased") from error
        finally:
            # There also where the disk was full in the middle of it.
            draft.unlink(missing_ok=True)
        return outcome

    def outcome(self) -> Outcome | None:
        """How the job ended; None before, or where the job is gone."""
        try:
            return Outcome.model_validate_json(self._read("outcome.json"))
        except JobGone:
            return None

    def read_checkpoint(self, name: str) -> bytes | None:
        """What an attempt left under a name; None where it left nothing."""
        return checkpoint_files.read_checkpoint(self.path, _checked(name))

    def write_checkpoint(self, name: str, content: bytes) -> None:
        """Leave something for a later attempt, unless the job has ended. Raises JobGone, OSError.

        Content must follow from the job alone: an attempt that was overtaken may write last.
        """
        try:
            checkpoint_files.write_checkpoint(self.path, _checked(name), content)
        except FileNotFoundError as error:
            if not self.exists():
                raise JobGone(f"job {self.job_id} was erased") from error

    def drop_checkpoints(self) -> None:
        """Remove what attempts left: the job has ended."""
        checkpoint_files.drop_checkpoints(self.path)

    def erase(self) -> None:
        """Remove everything. The rename is the instant of erasure; the rest frees space."""
        grave = self._root / f"{ERASED_PREFIX}{self.job_id}-{os.urandom(6).hex()}"
        try:
            self.path.rename(grave)
        except FileNotFoundError:
            return
        sync_folder(self._root)
        with contextlib.suppress(FileNotFoundError):  # a sweep is removing the same folder
            shutil.rmtree(grave)

    def _read(self, name: str) -> bytes:
        try:
            return (self.path / name).read_bytes()
        except FileNotFoundError as error:
            raise JobGone(f"job {self.job_id} has no {name}") from error


def _copy(source: Source, target: Path) -> None:
    if isinstance(source, bytes):
        target.write_bytes(source)
    elif isinstance(source, StoredInput):
        source.give(target)
    elif isinstance(source, Path):
        shutil.copyfile(source, target)
    else:
        source.seek(0)
        with target.open("xb") as file:
            shutil.copyfileobj(source, file)


def _checked(name: str) -> str:
    if not _FILE_NAME.fullmatch(name):
        raise ValueError(f"not a plain file name: {name!r}")
    return name
