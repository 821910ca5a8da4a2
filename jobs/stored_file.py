"""A published file, to be read in pieces wherever it is kept."""

import io
from collections.abc import Callable
from dataclasses import dataclass
from typing import BinaryIO, cast

_PIECE_BYTES = 1 << 20


@dataclass(frozen=True)
class StoredFile:
    """A file that is never written again. `open` gives a reader that can seek, to be closed."""

    bytes: int
    modified_at_s: float
    open: Callable[[], BinaryIO]


class PieceReader(io.RawIOBase):
    """A file that is only to be had in ranges, read from `fetch(start, end)`.

    fetch: returns the bytes from `start` up to `end`, fewer where the file has ended.
    """

    def __init__(self, fetch: Callable[[int, int], bytes]) -> None:
        super().__init__()
        self._fetch = fetch
        self._position = 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        if whence == io.SEEK_END:
            raise io.UnsupportedOperation("the end is not known here")
        self._position = offset + (self._position if whence == io.SEEK_CUR else 0)
        return self._position

    def tell(self) -> int:
        return self._position

    def readinto(self, buffer: "memoryview") -> int:  # type: ignore[override]  # typeshed: Buffer
        piece = self._fetch(self._position, self._position + len(buffer))
        buffer[: len(piece)] = piece
        self._position += len(piece)
        return len(piece)


def in_pieces(fetch: Callable[[int, int], bytes]) -> BinaryIO:
    """A buffered reader that fetches a megabyte at a time."""
    return cast(BinaryIO, io.BufferedReader(PieceReader(fetch), _PIECE_BYTES))
