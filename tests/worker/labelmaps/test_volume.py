"""Voxels read as integers, whatever they were stored as."""

import io
from pathlib import Path

import numpy as np
import pytest

from intake.limits import Limits
from intake.nifti_file import read_nifti_header
from schemas.labels import TissueLabels
from schemas.problem import InputError, ProblemType
from tests.labelmaps.heart_maps import SAX_AFFINE
from tests.labelmaps.nifti_bytes import CODES, gz, nifti
from worker.labelmaps.scheme import Tissue
from worker.labelmaps.volume import label_values, read_frames, to_tissues

LABELS = np.random.default_rng(0).integers(0, 5, (6, 5, 4, 3)).astype(np.uint8)


def frames(data: bytes, folder: Path) -> list[np.ndarray]:
    path = folder / "map"
    path.write_bytes(data)
    header = read_nifti_header(io.BytesIO(data), Limits(), "sax")
    return list(read_frames(path, header, "sax"))


@pytest.mark.parametrize("name", sorted(CODES))
@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("pack", [bytes, gz], ids=["plain", "gzip"])
def test_every_storage_reads_alike(
    name: str, version: int, order: str, pack: type, tmp_path: Path
) -> None:
    data = nifti(LABELS.astype(name), SAX_AFFINE, version=version, order=order)
    for index, frame in enumerate(frames(pack(data), tmp_path)):
        np.testing.assert_array_equal(frame, LABELS[..., index])
        assert np.issubdtype(frame.dtype, np.signedinteger)


def test_trailing_singletons(tmp_path: Path) -> None:
    (frame,) = frames(nifti(LABELS[..., :1, None], SAX_AFFINE), tmp_path)
    np.testing.assert_array_equal(frame, LABELS[..., 0])
    many = frames(nifti(LABELS[..., None, None], SAX_AFFINE), tmp_path)
    np.testing.assert_array_equal(many[2], LABELS[..., 2])


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ([0.0, 0.5], "no integers, such as 0.5"),
        ([1.0, np.nan], "NaN"),
        ([1.0, np.inf], "NaN or infinite"),
        ([1.0, 1e18], "1000000000000000000"),
        (np.arange(300.0), "300|299 different values"),
    ],
)
def test_what_is_no_label(values: list[float], says: str, tmp_path: Path) -> None:
    voxels = np.resize(np.asarray(values, np.float64), (10, 10, 4))
    with pytest.raises(InputError, match=says) as raised:
        frames(nifti(voxels, SAX_AFFINE), tmp_path)
    assert (raised.value.type, raised.value.pointer) == (
        ProblemType.UNSUPPORTED_LABEL_MAP,
        "sax",
    )


def test_large_and_negative_values_survive(tmp_path: Path) -> None:
    voxels = np.resize(np.array([0, -7, 820, 70_000], np.int32), (4, 4, 4))
    (frame,) = frames(nifti(voxels, SAX_AFFINE), tmp_path)
    assert label_values(frame) == {-7, 820, 70_000}


def test_tissues_of_a_scheme() -> None:
    labels = np.arange(8, dtype=np.int16).reshape(2, 2, 2)
    scheme = TissueLabels(lv_cavity=[1, 6], lv_wall=[2], rv_cavity=[4], rv_wall=[5], ignored=[3, 7])
    expected = [0, Tissue.LV_CAVITY, Tissue.LV_WALL, 0, Tissue.RV_CAVITY, Tissue.RV_WALL, 1, 0]
    assert to_tissues(labels, scheme).ravel().tolist() == expected
