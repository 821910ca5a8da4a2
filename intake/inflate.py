"""Bounded gunzip: a header's worth, or a count of the whole, never the whole in memory.

The first bytes decide whether a file is compressed; its name says nothing.
"""

import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from schemas.problem import InputError, ProblemType

GZIP_MAGIC = b"\x1f\x8b"

_CHUNK = 1 << 16
_HEAD_INPUT = 1 << 20
"""A gzip header may carry a file name of any length: how far to look for the first data."""
_MAX_MEMBERS = 1 << 16
"""Block-compressed files hold a member every 64 KiB; more than this many is an attack on time."""
_GZIP = zlib.MAX_WBITS | 16

Source = Path | BinaryIO
"""A file by path, or an open one that can seek. It is read from its start."""


def is_gzip(source: Source) -> bool:
    """Whether the first two bytes are gzip's."""
    with _opened(source) as file:
        return file.read(len(GZIP_MAGIC)) == GZIP_MAGIC


def read_head(source: Source, count: int, pointer: str | None = None) -> bytes:
    """The first `count` inflated bytes, fewer when there are no more; the rest is not looked at.

    Raises:
        InputError: `UNREADABLE_LABEL_MAP` when the compressed data is damaged that early.
    """
    if not is_gzip(source):
        with _opened(source) as file:
            return file.read(count)
    head = b""
    inflater = zlib.decompressobj(_GZIP)
    with _opened(source) as file:
        while len(head) < count and not inflater.eof and file.tell() < _HEAD_INPUT:
            chunk = inflater.unconsumed_tail or file.read(_CHUNK)
            if not chunk:
                break
            try:
                head += inflater.decompress(chunk, count - len(head))
            except zlib.error as error:
                raise _damaged(str(error), pointer) from error
    return head


def verify(source: Source, max_bytes: int, pointer: str | None = None) -> int:
    """Inflate the whole in small pieces, check it, and return how many bytes it holds.

    Members of one gzip stream follow one another as gzip allows, and zero bytes may pad the end.

    Raises:
        InputError (at `pointer`): `TOO_LARGE` (413) as soon as more than `max_bytes` have come out;
            `UNREADABLE_LABEL_MAP` when the data is cut short, fails its checksum, or is followed
            by bytes that are not gzip.
    """
    total = 0
    with _opened(source) as file:
        for size in _inflated_sizes(file, pointer) if is_gzip(source) else _plain_sizes(file):
            total += size
            if total > max_bytes:
                raise InputError(
                    ProblemType.TOO_LARGE,
                    f"the label map inflates to more than {max_bytes} bytes. Remedy: crop it to "
                    "the heart, store the labels as uint8, or send fewer frames a job.",
                    pointer=pointer,
                    status=413,
                )
    return total


@contextmanager
def _opened(source: Source) -> Iterator[BinaryIO]:
    if isinstance(source, Path):
        with source.open("rb") as file:
            yield file
    else:
        source.seek(0)
        yield source


def _plain_sizes(file: BinaryIO) -> Iterator[int]:
    file.seek(0)
    while chunk := file.read(_CHUNK):
        yield len(chunk)


def _inflated_sizes(file: BinaryIO, pointer: str | None) -> Iterator[int]:
    """Sizes of successive inflated pieces, none larger than a few chunks."""
    file.seek(0)
    inflater = zlib.decompressobj(_GZIP)
    members, pending = 1, b""
    while chunk := pending or file.read(_CHUNK):
        try:
            yield len(inflater.decompress(chunk, 4 * _CHUNK))
        except zlib.error as error:
            raise _damaged(str(error), pointer) from error
        pending = inflater.unconsumed_tail
        if inflater.eof:
            pending = _next_member(file, inflater.unused_data, pointer)
            if not pending:
                return
            members += 1
            if members > _MAX_MEMBERS:
                raise _damaged(f"it has more than {_MAX_MEMBERS} members", pointer)
            inflater = zlib.decompressobj(_GZIP)
    raise _damaged("it ends before its last block", pointer)


def _next_member(file: BinaryIO, rest: bytes, pointer: str | None) -> bytes:
    """The data of a member that follows the one just ended; empty at the end of the file."""
    while not (rest := rest.lstrip(b"\0")):
        rest = file.read(_CHUNK)
        if not rest:
            return b""
    if len(rest) < len(GZIP_MAGIC):
        rest += file.read(_CHUNK)
    if not rest.startswith(GZIP_MAGIC):
        raise _damaged("bytes that are not gzip follow its end", pointer)
    return rest


def _damaged(how: str, pointer: str | None) -> InputError:
    return InputError(
        ProblemType.UNREADABLE_LABEL_MAP,
        f"the gzip data is damaged: {how}. Remedy: check the file with `gzip -t` and send it anew.",
        pointer=pointer,
    )
