"""What a job computes from, as one hash: jobs that agree in it have one result by one code."""

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import BinaryIO

from jobs.errors import JobGone
from jobs.folder import Source
from jobs.stored_input import StoredInput, StoredObject
from schemas.messages import JobRequest

_CHUNK_BYTES = 1 << 20


def content_sha256(request: JobRequest, inputs: Mapping[str, Source]) -> str:
    """SHA-256 of study or label request, options with their presets filled in, and every file.

    Nothing that only says how to treat the job counts: owner, priority, keys, times. Raises JobGone
    where an input is another job's that was erased.
    """
    given = request.contours or request.labels
    content = {
        "kind": request.kind.value,
        "request": given.model_dump(mode="json") if given else None,
        "files": {view.value: _sha256(inputs[name]) for view, name in request.files.items()},
        "references": {name: _sha256(inputs[file]) for name, file in request.references.items()},
    }
    text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def _sha256(source: Source) -> str:
    digest = hashlib.sha256()
    for chunk in _chunks(source):
        digest.update(chunk)
    return digest.hexdigest()


def _chunks(source: Source) -> Iterable[bytes]:
    if isinstance(source, bytes):
        return (source,)
    if isinstance(source, StoredInput):
        return _of_path(source.path)
    if isinstance(source, StoredObject):
        return _closing(source.open())
    if isinstance(source, Path):
        return _of_path(source)
    source.seek(0)
    return _of_file(source)


def _of_path(path: Path) -> Iterator[bytes]:
    try:
        with path.open("rb") as file:
            yield from _of_file(file)
    except FileNotFoundError as error:
        raise JobGone(f"{path.name} was erased") from error


def _closing(file: BinaryIO) -> Iterator[bytes]:
    with file:
        yield from _of_file(file)


def _of_file(file: BinaryIO) -> Iterator[bytes]:
    while chunk := file.read(_CHUNK_BYTES):
        yield chunk
