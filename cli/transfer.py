"""One file from a server to a folder: taken up where it broke off, checked, and shown whole."""

import hashlib
import re
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import httpx

from cli.retrying import TryAgain
from schemas.artifacts import Artifact
from schemas.problem import InternalError, ProblemType, ServiceError

_BLOCK_BYTES = 1 << 20


def fetch(
    http: httpx.Client,
    path: str,
    artifact: Artifact,
    out: Path,
    refusal: Callable[[httpx.Response], TryAgain | ServiceError],
) -> None:
    """One attempt at an artifact. It takes its place in `out` only once it is whole.

    What arrived of it stays beside it, hidden, when the line breaks, under a name that no other
    content shares; the next attempt, of this process or another, asks for the rest (`Range`).

    Raises:
        TryAgain: where the line broke, or what was put together is damaged and is begun anew.
        InternalError: for a file that arrived damaged in one piece.
        ServiceError: as `refusal` has it for an answer that is no success.
        httpx.TransportError: where the server was not reached.
    """
    if _sha256(out / artifact.name) == artifact.sha256:
        return
    part = out / f".{artifact.name}.{artifact.sha256[:16]}.part"
    had = 0
    try:
        with part.open("a+b") as file:
            had = _usable(file, artifact)
            if had < artifact.bytes:
                _receive(http, path, artifact, file, refusal)
    except httpx.TransportError as error:
        if part.stat().st_size > had:
            raise TryAgain(_cut_off(artifact), progressed=True) from error
        raise
    finally:
        if part.stat().st_size == 0 < artifact.bytes:
            part.unlink()
    if _sha256(part) != artifact.sha256:
        part.unlink()
        raise TryAgain(_damaged(artifact)) if had else _damaged(artifact)
    part.replace(out / artifact.name)


def _usable(file: BinaryIO, artifact: Artifact) -> int:
    """How many bytes an earlier attempt left. More than there are to be had are none of them."""
    if file.tell() > artifact.bytes:
        file.truncate(0)
        file.seek(0)
    return file.tell()


def _receive(
    http: httpx.Client,
    path: str,
    artifact: Artifact,
    file: BinaryIO,
    refusal: Callable[[httpx.Response], TryAgain | ServiceError],
) -> None:
    """Append the rest of the artifact to `file`, or write all of it where the server sends that."""
    had = file.tell()
    headers = {"Accept-Encoding": "identity"}  # a range is one of the file's own bytes
    if had:
        headers |= {"Range": f"bytes={had}-", "If-Range": f'"{artifact.sha256}"'}
    with http.stream("GET", path, headers=headers) as response:
        if not response.is_success:
            response.read()
            raise refusal(response)
        if had and not _continues(response, had):
            file.truncate(0)
            file.seek(0)
        for chunk in response.iter_bytes():
            file.write(chunk)
            if file.tell() > artifact.bytes:
                return  # more than is listed: the check of the content will say so


def _continues(response: httpx.Response, had: int) -> bool:
    """Whether the answer is the rest of the file, from byte `had` on."""
    given = re.match(r"bytes (\d+)-", response.headers.get("content-range", ""))
    return response.status_code == 206 and given is not None and int(given[1]) == had


def _sha256(path: Path) -> str | None:
    """None where there is no such file."""
    digest = hashlib.sha256()
    try:
        with path.open("rb") as file:
            while block := file.read(_BLOCK_BYTES):
                digest.update(block)
    except FileNotFoundError:
        return None
    return digest.hexdigest()


def _damaged(artifact: Artifact) -> InternalError:
    return InternalError(
        ProblemType.INTERNAL,
        f"{artifact.name} arrived damaged (its SHA-256 is not the listed one); download it again",
    )


def _cut_off(artifact: Artifact) -> InternalError:
    return InternalError(
        ProblemType.UNAVAILABLE,
        f"the connection broke in the middle of {artifact.name}; run the command again to fetch "
        "the rest",
        status=503,
    )
