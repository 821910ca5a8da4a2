"""A job's folder on a disk.

    <root>/<job id>/request.json        what to do; there from the first instant
                    inputs/<name>       uploaded files
                    checkpoints/        how far attempts came, while it is not finished
                    staging-*/          one attempt's results while they are written
                    results/            the published results, manifest.json among them
                    outcome.json        how the job ended, once it has
                    announced           its end is in the webhooks' outbox (the service's mark)

Every step is fsynced, and a rename or a link, so a reader sees all of it or nothing.
"""

import contextlib
import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from jobs import checkpoint_files
from jobs.durable import sync_folder, sync_tree, write_durably
from jobs.errors import AlreadyPublished, JobGone
from jobs.folder import Source, check_staged, checked
from jobs.stored_file import StoredFile
from jobs.stored_input import StoredInput, StoredObject
from schemas.artifacts import MANIFEST_NAME, Manifest
from schemas.messages import JobOwner, JobRequest, Outcome

NEW_PREFIX = ".new-"
ERASED_PREFIX = ".erased-"

_ANNOUNCED = "announced"


class DiskFolder:
    """The folder of one job under `root`, whether or not it is there yet."""

    def __init__(self, root: Path, job_id: str) -> None:
        self.job_id = job_id
        self.path = root / job_id
        self._root = root

    def create(self, request: JobRequest, inputs: Mapping[str, Source]) -> None:
        """Write request and inputs, fsynced, and show the folder in one rename.

        A crash leaves only a hidden folder, which the store sweeps.
        """
        new = Path(tempfile.mkdtemp(prefix=NEW_PREFIX, dir=self._root))
        try:
            folder = new / "inputs"
            folder.mkdir()
            for name, source in inputs.items():
                _copy(source, folder / checked(name))
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
        return JobRequest.model_validate_json(self._read("request.json"))

    def owner(self) -> str:
        return JobOwner.model_validate_json(self._read("request.json")).owner

    def input_path(self, name: str) -> Path:
        """Where an input lies. Raises JobGone, also for a name that was never an input."""
        path = self.path / "inputs" / checked(name)
        if not path.is_file():
            raise JobGone(f"job {self.job_id} has no input {name}")
        return path

    def stored_input(self, name: str) -> StoredInput:
        return StoredInput(self.input_path(name))

    def local_input(self, name: str, staging: Path) -> Path:
        """The file itself: `staging` needs no copy of it."""
        return self.input_path(name)

    def staging(self, token: int) -> Path:
        try:
            return Path(tempfile.mkdtemp(prefix=f"staging-{token}-", dir=self.path))
        except FileNotFoundError as error:
            raise JobGone(f"job {self.job_id} has no folder") from error

    def drop_staging(self, staging: Path) -> None:
        # Gone already where it was published, or where the job was erased.
        shutil.rmtree(staging, ignore_errors=True)

    def publish(self, staging: Path, manifest: Manifest) -> None:
        try:
            check_staged(staging, manifest)
            write_durably(staging / MANIFEST_NAME, manifest.model_dump_json(indent=1).encode())
            sync_tree(staging)
            # A rename onto a folder that is not empty fails, and results/ is never empty.
            staging.rename(self.path / "results")
        except (FileNotFoundError, ValueError) as error:
            if self.exists():
                raise
            raise JobGone(f"job {self.job_id} was erased") from error
        except OSError as error:
            if (self.path / "results").is_dir():
                raise AlreadyPublished(f"job {self.job_id} has results already") from error
            raise
        sync_folder(self.path)

    def tidy(self) -> None:
        self.drop_checkpoints()
        for leftover in self.path.glob("staging-*"):
            # Of attempts whose worker died; one that still runs finds its token stale.
            self.drop_staging(leftover)

    def manifest(self) -> Manifest | None:
        try:
            return Manifest.model_validate_json(self._read(f"results/{MANIFEST_NAME}"))
        except JobGone:
            return None

    def artifact(self, name: str) -> StoredFile:
        path = self.path / "results" / MANIFEST_NAME
        if name != MANIFEST_NAME:  # it cannot list itself
            path = self.artifact_path(name)
        try:
            stat = path.stat()
        except FileNotFoundError as error:
            raise JobGone(f"job {self.job_id} has no {name}") from error
        return StoredFile(stat.st_size, stat.st_mtime, lambda: path.open("rb"))

    def artifact_path(self, name: str) -> Path:
        """Where a published artifact lies. Raises KeyError for a name not in the manifest."""
        manifest = self.manifest()
        for artifact in manifest.artifacts if manifest else ():
            if artifact.name == name:
                return self.path / "results" / artifact.name
        raise KeyError(name)

    def write_outcome(self, outcome: Outcome) -> Outcome:
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
        try:
            return Outcome.model_validate_json(self._read("outcome.json"))
        except JobGone:
            return None

    def read_checkpoint(self, name: str) -> bytes | None:
        return checkpoint_files.read_checkpoint(self.path, checked(name))

    def write_checkpoint(self, name: str, content: bytes) -> None:
        try:
            checkpoint_files.write_checkpoint(self.path, checked(name), content)
        except FileNotFoundError as error:
            if not self.exists():
                raise JobGone(f"job {self.job_id} was erased") from error

    def drop_checkpoints(self) -> None:
        checkpoint_files.drop_checkpoints(self.path)

    def mark_announced(self) -> None:
        try:
            write_durably(self.path / _ANNOUNCED, b"")
            sync_folder(self.path)
        except FileExistsError:
            return  # another process has done the same
        except FileNotFoundError as error:
            raise JobGone(f"job {self.job_id} was erased") from error

    def is_announced(self) -> bool:
        return (self.path / _ANNOUNCED).exists()

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
    elif isinstance(source, StoredObject):
        raise TypeError("an input of a job that is not kept on this disk")
    elif isinstance(source, Path):
        shutil.copyfile(source, target)
    else:
        source.seek(0)
        with target.open("xb") as file:
            shutil.copyfileobj(source, file)
