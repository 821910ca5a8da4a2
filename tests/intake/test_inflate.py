"""Bounded gunzip: what comes out is counted, capped, and checked to its last byte."""

import gzip
import io
import tracemalloc
import zlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from intake.inflate import is_gzip, read_head, verify
from schemas.problem import InputError, ProblemType

DATA = bytes(range(256)) * 2000


def gz(data: bytes) -> bytes:
    return gzip.compress(data, mtime=0)


@pytest.mark.parametrize("packed", [DATA, gz(DATA)], ids=["plain", "gzip"])
def test_counts_and_reads_the_same_from_a_file_and_a_path(packed: bytes, tmp_path: Path) -> None:
    path = tmp_path / "without-a-suffix"
    path.write_bytes(packed)
    for source in (path, io.BytesIO(packed)):
        assert verify(source, len(DATA)) == len(DATA)
        assert read_head(source, 540) == DATA[:540]


def test_magic_decides() -> None:
    assert is_gzip(io.BytesIO(gz(b"")))
    assert not is_gzip(io.BytesIO(b"\x1f"))
    assert not is_gzip(io.BytesIO(b""))


@given(st.lists(st.binary(max_size=300), min_size=1, max_size=6), st.integers(0, 40))
def test_members_add_up_and_zeros_may_pad_the_end(parts: list[bytes], padding: int) -> None:
    stream = io.BytesIO(b"".join(map(gz, parts)) + bytes(padding))
    assert verify(stream, 10_000) == sum(map(len, parts))


@given(st.binary(min_size=1, max_size=2000), st.data())
def test_any_cut_is_noticed(data: bytes, draw: st.DataObject) -> None:
    packed = gz(data)
    kept = draw.draw(st.integers(2, len(packed) - 1))
    with pytest.raises(InputError, match="ends before its last block") as raised:
        verify(io.BytesIO(packed[:kept]), 10_000, "sax")
    assert raised.value.type is ProblemType.UNREADABLE_LABEL_MAP
    assert raised.value.pointer == "sax"


@pytest.mark.parametrize(
    "packed",
    [
        gz(DATA)[:-8] + bytes(8),
        gz(DATA) + b"tail",
        gz(DATA) + b"\x1f",
        gz(DATA)[:20] + b"\xff\xff\xff\xff" + gz(DATA)[24:],
    ],
    ids=["checksum", "garbage", "one-byte", "body"],
)
def test_damage_is_unreadable(packed: bytes) -> None:
    with pytest.raises(InputError, match="Remedy") as raised:
        verify(io.BytesIO(packed), 10 * len(DATA))
    assert raised.value.type is ProblemType.UNREADABLE_LABEL_MAP


@pytest.mark.parametrize("packed", [DATA, gz(DATA)], ids=["plain", "gzip"])
def test_the_cap_is_exact(packed: bytes) -> None:
    assert verify(io.BytesIO(packed), len(DATA)) == len(DATA)
    with pytest.raises(InputError) as raised:
        verify(io.BytesIO(packed), len(DATA) - 1, "sax")
    assert (raised.value.type, raised.value.status) == (ProblemType.TOO_LARGE, 413)


def test_a_bomb_takes_neither_memory_nor_its_whole_length() -> None:
    """1 GiB of zeros, refused after 8 MiB."""
    deflater = zlib.compressobj(9, wbits=31)
    packed = b"".join(deflater.compress(bytes(1 << 20)) for _ in range(1024)) + deflater.flush()
    bomb = io.BytesIO(packed)
    tracemalloc.start()
    try:
        with pytest.raises(InputError) as raised:
            verify(bomb, 8 << 20)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert raised.value.type is ProblemType.TOO_LARGE
    assert peak < 4 << 20
    assert bomb.tell() < len(packed) // 8


def test_a_head_takes_no_more_than_it_needs() -> None:
    bomb = io.BytesIO(gz(bytes(64 << 20)))
    assert read_head(bomb, 540) == bytes(540)
    assert bomb.tell() <= 1 << 16


def test_a_file_name_without_end_is_not_followed() -> None:
    """FNAME of a gzip header, 8 MiB long."""
    packed = b"\x1f\x8b\x08\x08" + bytes(6) + b"a" * (8 << 20)
    source = io.BytesIO(packed)
    assert read_head(source, 540) == b""
    assert source.tell() <= 2 << 20


def test_members_without_content_are_an_attack() -> None:
    with pytest.raises(InputError, match="members"):
        verify(io.BytesIO(gz(b"") * 70_000), 1000)
