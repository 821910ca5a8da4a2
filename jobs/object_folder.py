"""A job's folder in a bucket.

    requests/<job id>.json              what to do; the job is there while this is
    jobs/<job id>/inputs/<name>         uploaded files, written before it
                  results-<random>/*    one attempt's results, nobody else's
                  manifest.json         whose results are the job's, and what they are
                  outcome.json          how the job ended, once it has
                  announced             its end is in the webhooks' outbox (the service's mark)
                  checkpoints/<name>    how far a running fit has come

Request, manifest and outcome are written only where there is none. Nothing can be renamed, so who
writes beside a request looks after it whether that is still there, and else takes all of it back;
what a process leaves that is killed in between, the store sweeps.
"""

import logging
import os
import shutil
import tempfile
from collections.abc import Mapping
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

from jobs.bucket import Bucket, Listed
from jobs.errors import AlreadyPublished, JobGone
from jobs.folder import Source, check_staged, checked
from jobs.scratch import Scratch
from jobs.store_errors import StoreUnavailable
from jobs.stored_file import StoredFile, in_pieces
from jobs.stored_input import StoredInput, StoredObject
from schemas.artifacts import MANIFEST_NAME, Manifest
from schemas.base import WireModel
from schemas.messages import JobOwner, JobRequest, Outcome

REQUESTS = "requests/"
JOBS = "jobs/"

_MARK = b"1"

_LOGGER = logging.getLogger(__name__)


class _Published(WireModel):
    """`manifest.json`: the attempt whose results stand, and their manifest."""

    results: str
    manifest: Manifest


class ObjectFolder:
    """The folder of one job in `bucket`, whether or not it is there yet."""

    def __init__(self, bucket: Bucket, scratch: Scratch, job_id: str) -> None:
        self.job_id = job_id
        self._bucket = bucket
        self._scratch = scratch
        self._request_key = f"{REQUESTS}{job_id}.json"
        self._home = f"{JOBS}{job_id}/"

    def create(self, request: JobRequest, inputs: Mapping[str, Source]) -> None:
        for name in inputs:
            checked(name)
        if self.exists():
            raise FileExistsError(f"job {self.job_id} has a folder already")
        try:
            for name, source in inputs.items():
                self._keep(source, f"{self._home}inputs/{name}")
            is_new = self._bucket.put_new(self._request_key, request.model_dump_json().encode())
        except BaseException:
            # The request too: the server may have it, although it did not say so.
            self._erase_unless_it_fails()
            raise
        if not is_new:
            raise FileExistsError(f"job {self.job_id} has a folder already")

    def exists(self) -> bool:
        return self._bucket.exists(self._request_key)

    def request(self) -> JobRequest:
        return JobRequest.model_validate_json(self._read(self._request_key))

    def owner(self) -> str:
        return JobOwner.model_validate_json(self._read(self._request_key)).owner

    def stored_input(self, name: str) -> StoredObject:
        listed = self._input(name)
        return StoredObject(listed.key, partial(self._open, listed))

    def local_input(self, name: str, staging: Path) -> Path:
        listed = self._input(name)
        folder = staging.parent / "inputs"
        folder.mkdir(exist_ok=True)
        path = folder / name
        with self._open(listed) as source, path.open("wb") as file:
            shutil.copyfileobj(source, file)
        return path

    def staging(self, token: int) -> Path:
        if not self.exists():
            raise JobGone(f"job {self.job_id} has no folder")
        return Path(tempfile.mkdtemp(prefix=f"staging-{token}-", dir=self._scratch.folder()))

    def drop_staging(self, staging: Path) -> None:
        self._scratch.drop(staging.parent)

    def publish(self, staging: Path, manifest: Manifest) -> None:
        check_staged(staging, manifest)
        self._require()
        if self.manifest() is not None:
            raise AlreadyPublished(f"job {self.job_id} has results already")
        results = f"results-{os.urandom(8).hex()}"
        for artifact in manifest.artifacts:
            key = f"{self._home}{results}/{artifact.name}"
            self._bucket.put_file(key, staging / artifact.name)
        published = _Published(results=results, manifest=manifest)
        is_first = self._bucket.put_new(
            self._home + MANIFEST_NAME, published.model_dump_json().encode()
        )
        self._require_still()
        if not is_first:
            self._delete_under(f"{self._home}{results}/")
            raise AlreadyPublished(f"job {self.job_id} has results already")

    def tidy(self) -> None:
        self.drop_checkpoints()
        published = self._published()
        standing = f"{self._home}{published.results}/" if published else None
        for listed in self._bucket.under(f"{self._home}results-"):
            if standing is None or not listed.key.startswith(standing):
                self._bucket.delete(listed.key)

    def manifest(self) -> Manifest | None:
        published = self._published()
        return published.manifest if published else None

    def artifact(self, name: str) -> StoredFile:
        published = self._published()
        if name == MANIFEST_NAME and published is not None:
            return self._manifest_file(published)
        if published is None or name not in {a.name for a in published.manifest.artifacts}:
            raise KeyError(name)
        key = f"{self._home}{published.results}/{name}"
        listed = self._bucket.look(key)
        if listed is None:
            raise JobGone(f"job {self.job_id} has no {name}")
        return StoredFile(listed.bytes, listed.modified_at.timestamp(), partial(self._open, listed))

    def write_outcome(self, outcome: Outcome) -> Outcome:
        self._require()
        key = f"{self._home}outcome.json"
        is_first = self._bucket.put_new(key, outcome.model_dump_json().encode())
        self._require_still()
        return outcome if is_first else Outcome.model_validate_json(self._read(key))

    def outcome(self) -> Outcome | None:
        content = self._bucket.get(f"{self._home}outcome.json")
        return None if content is None else Outcome.model_validate_json(content)

    def mark_announced(self) -> None:
        self._require()
        self._bucket.put(f"{self._home}announced", _MARK)
        self._require_still()

    def is_announced(self) -> bool:
        return self._bucket.exists(f"{self._home}announced")

    def read_checkpoint(self, name: str) -> bytes | None:
        """What was last written under the name; None where nothing was, or the job is gone."""
        return self._bucket.get(f"{self._home}checkpoints/{checked(name)}")

    def write_checkpoint(self, name: str, content: bytes) -> None:
        """Keep content under a name, unless the job has ended. Raises JobGone."""
        self._require()
        self._bucket.put(f"{self._home}checkpoints/{checked(name)}", content)
        self._require_still()
        if self.outcome() is not None:
            self.drop_checkpoints()

    def drop_checkpoints(self) -> None:
        self._delete_under(f"{self._home}checkpoints/")

    def erase(self) -> None:
        """Delete the request, which is the instant of erasure, then all the rest."""
        self._bucket.delete(self._request_key)
        self._delete_under(self._home)

    def _input(self, name: str) -> Listed:
        listed = self._bucket.look(f"{self._home}inputs/{checked(name)}")
        if listed is None:
            raise JobGone(f"job {self.job_id} has no input {name}")
        return listed

    def _require(self) -> None:
        if not self.exists():
            raise JobGone(f"job {self.job_id} was erased")

    def _require_still(self) -> None:
        """To be asked after each write: the job may have been erased right before it."""
        if not self.exists():
            self._delete_under(self._home)
            raise JobGone(f"job {self.job_id} was erased")

    def _published(self) -> _Published | None:
        content = self._bucket.get(self._home + MANIFEST_NAME)
        return None if content is None else _Published.model_validate_json(content)

    def _manifest_file(self, published: _Published) -> StoredFile:
        content = published.manifest.model_dump_json(indent=1).encode()
        return StoredFile(
            len(content), published.manifest.created_at.timestamp(), partial(BytesIO, content)
        )

    def _open(self, listed: Listed) -> BinaryIO:
        def fetch(start: int, end: int) -> bytes:
            if start >= listed.bytes:
                return b""
            piece = self._bucket.get_range(listed.key, start, min(end, listed.bytes))
            if piece is None:
                raise JobGone(f"job {self.job_id} was erased")
            return piece

        return in_pieces(fetch)

    def _keep(self, source: Source, key: str) -> None:
        if isinstance(source, bytes):
            self._bucket.put(key, source)
        elif isinstance(source, StoredObject):
            if not self._bucket.copy(source.key, key):
                raise JobGone("an input of the other job was erased")
        elif isinstance(source, StoredInput):
            raise TypeError("an input of a job that is not kept in this bucket")
        elif isinstance(source, Path):
            self._bucket.put_file(key, source)
        else:
            self._keep_open_file(source, key)

    def _keep_open_file(self, source: BinaryIO, key: str) -> None:
        folder = self._scratch.folder()
        try:
            source.seek(0)
            with (folder / "input").open("xb") as file:
                shutil.copyfileobj(source, file)
            self._bucket.put_file(key, folder / "input")
        finally:
            self._scratch.drop(folder)

    def _erase_unless_it_fails(self) -> None:
        try:
            self.erase()
        except StoreUnavailable as error:
            _LOGGER.warning("job %s was not made, and leaves something: %s", self.job_id, error)

    def _delete_under(self, start: str) -> None:
        for listed in list(self._bucket.under(start)):
            self._bucket.delete(listed.key)

    def _read(self, key: str) -> bytes:
        content = self._bucket.get(key)
        if content is None:
            raise JobGone(f"job {self.job_id} was erased")
        return content
