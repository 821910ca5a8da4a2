"""An archive that is made while it is sent: whole for any reader, and small in memory."""

import io
import tracemalloc
import zipfile
from collections.abc import Iterator
from datetime import UTC, datetime

import pytest

from service.zip_stream import ZipMember, zip_stream

WHEN = datetime(2026, 1, 2, 3, 4, 6, tzinfo=UTC)


def member(name: str, *chunks: bytes) -> ZipMember:
    return ZipMember(name, sum(map(len, chunks)), WHEN, chunks)


def test_what_goes_in_comes_out() -> None:
    files = {"a/one.stl": [b"12", b"", b"345"], "a/empty": [], "b/é.json": [b"{}"]}
    content = b"".join(zip_stream(member(name, *chunks) for name, chunks in files.items()))
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        assert archive.testzip() is None
        assert {name: archive.read(name) for name in archive.namelist()} == {
            name: b"".join(chunks) for name, chunks in files.items()
        }
        info = archive.infolist()[0]
    assert (info.compress_type, info.date_time) == (zipfile.ZIP_STORED, (2026, 1, 2, 3, 4, 6))


def test_an_archive_without_members() -> None:
    assert zipfile.ZipFile(io.BytesIO(b"".join(zip_stream([])))).namelist() == []


def test_it_holds_no_more_than_a_chunk() -> None:
    chunk = bytes(1 << 20)

    def members() -> Iterator[ZipMember]:
        for number in range(4):
            yield ZipMember(f"{number}", 16 << 20, WHEN, (chunk for _ in range(16)))

    tracemalloc.start()
    size = sum(len(piece) for piece in zip_stream(members()))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert size > 64 << 20
    assert peak < 8 << 20


@pytest.mark.slow
def test_a_member_of_five_gigabytes_is_zip64() -> None:
    chunk = bytes(1 << 24)
    big = ZipMember("big", 320 << 24, WHEN, (chunk for _ in range(320)))
    pieces = zip_stream([big, member("small", b"x")])
    head, size, tail = next(pieces), 0, b""
    size = len(head)
    for piece in pieces:
        size += len(piece)
        tail = (tail + piece)[-400:]
    assert size > 5 << 30
    assert b"PK\x06\x06" in tail, "the directory is ZIP64"
    assert head[28:30] == b"\x14\x00", "room for long sizes in the member's own head"


def test_what_breaks_off_is_no_archive() -> None:
    def broken() -> Iterator[bytes]:
        yield b"12"
        raise OSError("gone")

    sent = bytearray()
    pieces = zip_stream([member("a", b"1"), ZipMember("b", 4, WHEN, broken())])

    def receive() -> None:
        for piece in pieces:
            sent.extend(piece)

    with pytest.raises(OSError, match="gone"):
        receive()
    assert sent
    with pytest.raises(zipfile.BadZipFile):
        zipfile.ZipFile(io.BytesIO(sent))
