"""RT Structure Sets that are none, or try to cost: each refused in words, at a bounded price."""

import contextlib
import struct
import tracemalloc
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydicom.dataset import Dataset
from pydicom.uid import DeflatedExplicitVRLittleEndian, ImplicitVRLittleEndian, MRImageStorage

from intake.formats import dicom_layout
from intake.formats.rtstruct import read_rtstruct
from intake.limits import Limits
from schemas.problem import InputError
from tests.intake.formats.clinical_bytes import (
    PATIENT,
    RT_STRUCTURE_SET,
    contour,
    image,
    rtstruct,
    saved,
    structure_set,
)
from tests.intake.formats.test_rtstruct import at, ring, stack, tilted

GOOD = rtstruct([("LV_ENDO", stack([0, 8, 16])), ("other", stack([0]))])
IMPLICIT = rtstruct([("LV_ENDO", stack([0, 8, 16]))], ImplicitVRLittleEndian)
START = GOOD.index(b"\x08\x00\x16\x00UI")
"""Where the data set begins after its meta information."""


def refusal(data: bytes, limits: Limits | None = None, **more: bytes) -> InputError:
    with pytest.raises(InputError) as raised:
        read_rtstruct({"file": data, **more}, limits=limits or Limits())
    detail = raised.value.detail
    assert "Remedy: " in detail
    assert PATIENT not in detail
    assert "4711" not in detail
    return raised.value


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "neither"),
        (b"solid nothing", "neither"),
        (GOOD[132:], "neither"),
        (GOOD[:-5], "ends within"),
        (GOOD[: len(GOOD) // 2], "ends within"),
        (GOOD[:140], "transfer syntax"),
        (GOOD[:132], "transfer syntax"),
        (GOOD.replace(b"\x02\x00\x10\x00UI\x14", b"\x02\x00\x10\x00U\0\0"), "transfer syntax"),
        (GOOD.replace(b"1.2.840.10008.1.2.1\0", b"1.2.999.10008.1.2.1\0"), "transfer syntax"),
        (GOOD[:START] + IMPLICIT[IMPLICIT.index(b"\x08\x00\x16\x00") :], "value representation"),
    ],
)
def test_what_is_no_sound_dicom_file(data: bytes, words: str) -> None:
    error = refusal(data)
    assert words in error.detail
    assert error.pointer == "file"


def test_another_kind_of_dicom_file() -> None:
    assert "another kind" in refusal(image("1.2", at(0))).detail
    other = saved(structure_set([("LV_ENDO", stack([0]))]), MRImageStorage)
    assert "another kind" in refusal(other).detail


def test_explicit_values_under_an_implicit_syntax() -> None:
    start = IMPLICIT.index(b"\x08\x00\x16\x00")
    assert "explicit VR" in refusal(IMPLICIT[:start] + GOOD[START:]).detail


@pytest.mark.parametrize("rois", [[], [("LV_ENDO", [])]])
def test_no_region_and_no_contour(rois: list) -> None:
    assert "outline" in refusal(rtstruct(rois)).detail


def test_a_companion_that_is_neither_image_nor_table() -> None:
    error = refusal(GOOD, notes=b"hello")
    assert error.pointer == "notes"


@pytest.mark.parametrize("value", [b"nan", b"inf", b"1e9", b"abc", b""])
def test_coordinates_that_are_no_finite_numbers(value: bytes) -> None:
    first = GOOD.index(b"20.000000")
    data = GOOD[:first] + value.ljust(9) + GOOD[first + 9 :]
    assert "finite numbers" in refusal(data).detail


def test_points_that_are_not_as_many_as_said() -> None:
    item = contour(ring())
    item.NumberOfContourPoints = 25
    assert "number of points" in refusal(rtstruct([("LV_ENDO", [item])])).detail
    item.ContourData = [*item.ContourData, "1"]
    assert "triplets" in refusal(rtstruct([("LV_ENDO", [item])])).detail


def test_a_contour_on_one_line() -> None:
    line = np.linspace(0, 10, 7)[:, None] * [[1.0, 2, 3]]
    assert "one line" in refusal(rtstruct([("LV_ENDO", [contour(line)])])).detail


def test_more_than_the_limits() -> None:
    assert refusal(GOOD, Limits(max_contours=2)).status == 413
    assert refusal(GOOD, Limits(max_points=50)).status == 413
    assert refusal(GOOD, Limits(max_points_per_contour=20)).status == 413


def test_private_tags_and_unknown_sequences_are_passed_over() -> None:
    dataset = structure_set([("LV_ENDO", stack([0, 8, 16]))])
    block = dataset.private_block(0x3007, "vendor", create=True)
    block.add_new(1, "LO", "secret")
    inner = Dataset()
    inner.PatientComments = PATIENT
    block.add_new(2, "SQ", [inner])
    dataset.RTROIObservationsSequence = [Dataset()]
    for syntax in ("1.2.840.10008.1.2", "1.2.840.10008.1.2.1"):
        imported = read_rtstruct({"file": saved(dataset, RT_STRUCTURE_SET, syntax)})
        assert len(imported.study.frames[0].slices) == 3


def test_sequences_without_length_are_read() -> None:
    dataset = structure_set([("LV_ENDO", stack([0, 8, 16]))])
    for sequence in (dataset.ROIContourSequence, dataset.ROIContourSequence[0].ContourSequence):
        sequence.is_undefined_length = True
        for one in sequence:
            one.is_undefined_length_sequence_item = True
    for element in (
        dataset["ROIContourSequence"],
        dataset.ROIContourSequence[0]["ContourSequence"],
    ):
        element.is_undefined_length = True
    data = saved(dataset, RT_STRUCTURE_SET)
    assert len(read_rtstruct({"file": data}).study.frames[0].slices) == 3
    refusal(data[:-9])


@pytest.mark.parametrize("letters", ["ISO_IR 192", "ISO_IR 100", "GB18030", "no such set"])
def test_names_in_other_character_sets(letters: str) -> None:
    data = rtstruct([("LV_ENDO", stack([0])), ("name", stack([0]))])
    element = b"\x08\x00\x05\x00CS" + struct.pack("<H", 12) + letters.encode().ljust(12)
    start = data.index(b"\x08\x00\x16\x00UI")
    imported = read_rtstruct({"file": data[:start] + element + data[start:]})
    assert "'name'" in " ".join(imported.warnings)


def implicit(tag: int, value: bytes, length: int | None = None) -> bytes:
    stated = len(value) if length is None else length
    return struct.pack("<HHI", tag >> 16, tag & 0xFFFF, stated) + value


HEAD = IMPLICIT[: IMPLICIT.index(b"\x08\x00\x16\x00")]
CLASS = implicit(0x00080016, RT_STRUCTURE_SET.encode() + b"\0")
NO_LENGTH = 0xFFFFFFFF
ITEM = 0xFFFEE000
SIZE = 32 << 20


@pytest.mark.parametrize(
    "bomb",
    [
        implicit(0x30060039, implicit(ITEM, b"") * (SIZE // 8)),
        implicit(0x30060039, implicit(ITEM, b"") * (SIZE // 8), NO_LENGTH),
        implicit(0x30070039, implicit(ITEM, b"") * (SIZE // 8), NO_LENGTH),
        implicit(0x30060039, implicit(ITEM, b"", NO_LENGTH) * (SIZE // 8), NO_LENGTH),
        (implicit(0x30060039, b"", NO_LENGTH) + implicit(ITEM, b"", NO_LENGTH)) * 100_000,
        b"".join(implicit(0x30080000 + n, b"") for n in range(400_000)),
    ],
    ids=["items", "items-no-length", "private-items", "open-items", "deep", "elements"],
)
def test_bombs_are_found_before_they_are_read(bomb: bytes) -> None:
    tracemalloc.start()
    error = refusal(HEAD + CLASS + bomb)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 4 * SIZE + (16 << 20)
    assert error.pointer == "file"


def test_a_deflated_bomb_is_not_inflated_whole() -> None:
    head = rtstruct([], DeflatedExplicitVRLittleEndian)
    head = head[: 144 + int.from_bytes(head[140:144], "little")]
    packer = zlib.compressobj(wbits=-15)
    data = head + packer.compress(bytes(64 << 20)) + packer.flush()
    tracemalloc.start()
    error = refusal(data, Limits(max_inflated_bytes=1 << 20))
    assert tracemalloc.get_traced_memory()[1] < 8 << 20
    tracemalloc.stop()
    assert error.status == 413


def test_a_deflated_file_that_ends_early_or_is_damaged() -> None:
    data = rtstruct([("LV_ENDO", stack([0]))], DeflatedExplicitVRLittleEndian)
    assert "deflated" in refusal(data[:-20]).detail


def test_a_file_of_the_largest_size_is_read_or_refused_with_little_memory() -> None:
    """Ten thousand contours of 200 points: more than a study may hold, and 40 MB as text."""
    dataset = structure_set([("LV_ENDO", []), ("skin", [])])
    many = contour(tilted(ring(points=2000)))
    dataset.ROIContourSequence[1].ContourSequence = [many] * 500
    dataset.ROIContourSequence[0].ContourSequence = stack([0, 8, 16])
    data = saved(dataset, RT_STRUCTURE_SET, ImplicitVRLittleEndian)
    assert len(data) > 25 << 20
    tracemalloc.start()
    imported = read_rtstruct({"file": data})
    assert tracemalloc.get_traced_memory()[1] < 4 * len(data)
    tracemalloc.stop()
    assert len(imported.study.frames[0].slices) == 3


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_any_change_of_bytes_is_read_or_refused(data: st.DataObject) -> None:
    for source in (GOOD, IMPLICIT):
        changed = bytearray(source)
        for _ in range(data.draw(st.integers(1, 4))):
            where = data.draw(st.integers(132, len(changed) - 1))
            changed[where] = data.draw(st.integers(0, 255))
        cut = data.draw(st.integers(1, 1 << 16))
        with contextlib.suppress(InputError):
            assert read_rtstruct({"file": bytes(changed[:cut])}).study.frames


def test_the_walk_counts_every_element(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dicom_layout, "MAX_ELEMENTS", 10)
    assert refusal(GOOD).status == 413
