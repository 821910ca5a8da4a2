"""The header: every layout read alike, and a header that lies is caught."""

import io
import itertools
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from intake.limits import Limits
from intake.nifti_file import read_nifti_header
from intake.nifti_header import NiftiHeader, parse_nifti_header
from schemas.problem import InputError, ProblemType
from tests.labelmaps.heart_maps import SAX_AFFINE
from tests.labelmaps.nifti_bytes import CODES, gz, nifti

VOXELS = np.arange(4 * 3 * 2, dtype=np.uint8).reshape(4, 3, 2)


def read(data: bytes, limits: Limits | None = None) -> NiftiHeader:
    return read_nifti_header(io.BytesIO(data), limits or Limits(), "sax")


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("pack", [bytes, gz], ids=["plain", "gzip"])
def test_all_layouts_say_the_same(version: int, order: str, pack: type) -> None:
    data = pack(nifti(VOXELS, SAX_AFFINE, version=version, order=order, units=10, time_step=0.04))
    header = read(data)
    assert (header.version, header.big_endian) == (version, order == ">")
    assert (header.shape, header.frames) == ((4, 3, 2), 1)
    assert header.vox_offset == {1: 352, 2: 544}[version]
    assert header.pixdim == (2.0, 2.0, 8.0)
    assert header.mm_per_unit == 1.0
    assert header.time_step_ms == pytest.approx(40.0)
    assert header.quaternion is None
    np.testing.assert_allclose(header.sform, SAX_AFFINE[:3])


@pytest.mark.parametrize("name", sorted(CODES))
def test_every_integer_and_real_type(name: str) -> None:
    header = read(nifti(VOXELS.astype(name), SAX_AFFINE))
    assert header.data_type == name
    assert header.voxel_bytes == np.dtype(name).itemsize


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        ((4, 3, 2), ((4, 3, 2), 1)),
        ((4, 3, 1), ((4, 3, 1), 1)),
        ((4, 3, 2, 5), ((4, 3, 2), 5)),
        ((4, 3, 1, 5, 1), ((4, 3, 1), 5)),
        ((4, 3, 2, 1, 1, 1, 1), ((4, 3, 2), 1)),
    ],
)
def test_dimensions(shape: tuple[int, ...], expected: tuple[tuple[int, ...], int]) -> None:
    header = read(nifti(np.zeros(shape, np.uint8), SAX_AFFINE))
    assert (header.shape, header.frames) == expected


def test_dimensions_past_the_count_are_not_looked_at() -> None:
    assert read(nifti(VOXELS, SAX_AFFINE, dim=[3, 4, 3, 2, -7, 0, 9, 9])).frames == 1


@pytest.mark.parametrize(
    ("dim", "problem"),
    [
        ([0, 4, 3, 2, 1, 1, 1, 1], ProblemType.UNREADABLE_LABEL_MAP),
        ([8, 4, 3, 2, 1, 1, 1, 1], ProblemType.UNREADABLE_LABEL_MAP),
        ([3, 4, 0, 2, 1, 1, 1, 1], ProblemType.UNREADABLE_LABEL_MAP),
        ([2, 4, 6, 1, 1, 1, 1, 1], ProblemType.UNSUPPORTED_LABEL_MAP),
        ([5, 4, 3, 1, 1, 2, 1, 1], ProblemType.UNSUPPORTED_LABEL_MAP),
    ],
)
def test_dimensions_that_are_refused(dim: list[int], problem: ProblemType) -> None:
    with pytest.raises(InputError) as raised:
        read(nifti(VOXELS, SAX_AFFINE, dim=dim))
    assert (raised.value.type, raised.value.pointer) == (problem, "sax")


@pytest.mark.parametrize(
    ("units", "mm", "ms"),
    [
        (0, 1, None),
        (1, 1000, None),
        (2, 1, None),
        (3, 0.001, None),
        (10, 1, 3000),
        (18, 1, 3),
        (26, 1, 0.003),
        (34, 1, None),
    ],
)
def test_units(units: int, mm: float, ms: float | None) -> None:
    header = read(nifti(VOXELS, SAX_AFFINE, units=units, time_step=3.0))
    assert header.mm_per_unit == mm
    assert header.time_step_ms == (None if ms is None else pytest.approx(ms))


@pytest.mark.parametrize("step", [0.0, -1.0, np.nan, np.inf])
def test_a_time_step_that_is_none(step: float) -> None:
    assert read(nifti(VOXELS, SAX_AFFINE, units=10, time_step=step)).time_step_ms is None


def test_extensions_before_the_voxels() -> None:
    plain = nifti(VOXELS, SAX_AFFINE, vox_offset=352 + 64)
    data = plain[:352] + bytes(64) + plain[352:]
    assert read(data).vox_offset == 416


@pytest.mark.parametrize("offset", [-16.0, 0.0, 348.0, 352.5, np.nan, np.inf])
def test_voxels_begin_after_the_header(offset: float) -> None:
    with pytest.raises(InputError) as raised:
        read(nifti(VOXELS, SAX_AFFINE, vox_offset=offset))
    assert raised.value.type is ProblemType.UNREADABLE_LABEL_MAP


@pytest.mark.parametrize("change", [-1, 1])
def test_bytes_present_are_bytes_promised(change: int) -> None:
    data = nifti(VOXELS, SAX_AFFINE)
    held = data[:change] if change < 0 else data + bytes(change)
    with pytest.raises(InputError, match=f"promises {len(data)} bytes .* holds {len(held)}"):
        read(gz(held))


@pytest.mark.parametrize(
    "limits",
    [Limits(max_voxels=23), Limits(max_inflated_bytes=375), Limits(max_frames=0)],
    ids=["voxels", "bytes", "frames"],
)
def test_limits_are_exact_and_judged_before_the_voxels(limits: Limits) -> None:
    data = nifti(VOXELS, SAX_AFFINE)
    assert read(data, Limits(max_voxels=24, max_inflated_bytes=376, max_frames=1)).frames == 1
    with pytest.raises(InputError) as raised:
        read(data[:352], limits)
    assert (raised.value.type, raised.value.status) == (ProblemType.TOO_LARGE, 413)


def test_two_dimensions_of_size_may_not_overflow() -> None:
    """The largest numbers that NIfTI-2 can hold make a product, not a negative number."""
    data = nifti(VOXELS, SAX_AFFINE, version=2, dim=[3, *[2**62] * 3, 1, 1, 1, 1])
    with pytest.raises(InputError) as raised:
        read(data)
    assert raised.value.type is ProblemType.TOO_LARGE


@given(st.binary(max_size=600))
def test_any_bytes_are_answered(data: bytes) -> None:
    with pytest.raises(InputError):
        read(data)


@given(st.lists(st.tuples(st.integers(0, 551), st.integers(0, 255)), min_size=1, max_size=8))
def test_any_damage_to_a_header_is_answered(damage: list[tuple[int, int]]) -> None:
    """A header is read, or refused with a problem: never another exception."""
    for version, order in itertools.product((1, 2), "<>"):
        data = bytearray(nifti(VOXELS, SAX_AFFINE, version=version, order=order))
        for at, value in damage:
            if at < len(data):
                data[at] = value
        with suppress(InputError):
            assert parse_nifti_header(bytes(data), "sax").inflated_bytes > 0
