"""A ZIP archive as a stream: members stored as they are, nothing kept but their names.

Meshes are large and reports small, and who sends them compresses the connection if at all; storing
keeps the archive as fast as the disk. Sizes are told before a member, so that ZIP64 is used where
it is needed and only there; checksums follow it, as in every archive that is written without
seeking.
"""

import io
import zipfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime
from typing import BinaryIO

_CHUNK = 1 << 18


@dataclass(frozen=True)
class ZipMember:
    """One file of the archive. chunks: its content, read when its turn comes."""

    name: str
    size: int
    modified: datetime
    chunks: Iterable[bytes]


class _Sink(io.RawIOBase):
    """What the archive is written to: it holds what was not yet handed on, and cannot seek."""

    def __init__(self) -> None:
        super().__init__()
        self._held: list[bytes] = []

    def writable(self) -> bool:
        return True

    def write(self, chunk: "bytes | bytearray | memoryview") -> int:  # type: ignore[override]
        self._held.append(bytes(chunk))
        return len(chunk)

    def taken(self) -> bytes:
        """What was written since the last time."""
        held, self._held = b"".join(self._held), []
        return held


def zip_stream(members: Iterable[ZipMember]) -> Iterator[bytes]:
    """The archive, piece by piece. What reading a member raises ends it without its directory, so
    that nobody takes a part for the whole.
    """
    sink = _Sink()
    # Not a context: an archive that was broken off must not be closed as if it were whole.
    archive = zipfile.ZipFile(sink, "w", zipfile.ZIP_STORED)
    for member in members:
        info = zipfile.ZipInfo(member.name, member.modified.timetuple()[:6])
        info.external_attr = 0o644 << 16
        info.file_size = member.size
        with archive.open(info, "w") as target:
            for chunk in member.chunks:
                target.write(chunk)
                yield sink.taken()
    archive.close()
    yield sink.taken()


def chunks_of(file: BinaryIO) -> Iterator[bytes]:
    """The content of an open file, which is closed at its end."""
    with file:
        while chunk := file.read(_CHUNK):
            yield chunk
