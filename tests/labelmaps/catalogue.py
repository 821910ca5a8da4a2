"""The catalogue of bad label maps: each with the problem it must be answered with, and where.

Data, for the tests of the reader, of the door, and of the HTTP service. `where` is "door" for what
the headers tell (a 4xx answer to the submission), "worker" for what takes the voxels (a job that
fails with this problem), "accepted" for what looks wrong and is right.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from schemas.problem import ProblemType
from tests.labelmaps.heart_maps import (
    ACDC_NAMES,
    LAX_AFFINE,
    SAX_AFFINE,
    SAX_SHAPE,
    lax,
    renamed,
    sax,
)
from tests.labelmaps.nifti_bytes import gz, nifti

Where = Literal["door", "worker", "accepted"]


@dataclass(frozen=True)
class LabelMapCase:
    """One submission. `files` builds its file parts, by name, when called.

    says: words that the problem's detail must hold, the remedy above all.
    """

    name: str
    files: Callable[[], Mapping[str, bytes]]
    where: Where
    problem: ProblemType | None
    status: int
    pointer: str | None
    request: Mapping[str, Any] = field(
        default_factory=lambda: {"subject_id": "bad", "label_scheme": "mnms"}
    )
    says: tuple[str, ...] = ()


def _sax(data: Callable[[], bytes]) -> Callable[[], Mapping[str, bytes]]:
    return lambda: {"sax": data()}


def _map(
    voxels: Callable[[], np.ndarray] = sax, affine: np.ndarray | None = SAX_AFFINE, **fields: Any
) -> Callable[[], bytes]:
    """A compressed short-axis map with some fields of its header changed."""
    return lambda: gz(nifti(voxels(), affine, **fields))


def _door(
    name: str,
    data: Callable[[], bytes],
    problem: ProblemType,
    *says: str,
    status: int = 422,
    pointer: str = "sax",
) -> LabelMapCase:
    return LabelMapCase(name, _sax(data), "door", problem, status, pointer, says=says)


def _worker(
    name: str,
    data: Callable[[], bytes],
    problem: ProblemType,
    *says: str,
    pointer: str = "sax",
) -> LabelMapCase:
    return LabelMapCase(name, _sax(data), "worker", problem, 422, pointer, says=says)


def _moved(affine: np.ndarray, by_mm: float) -> np.ndarray:
    moved = affine.copy()
    moved[0, 3] += by_mm
    return moved


def _with_element(affine: np.ndarray, row: int, column: int, value: float) -> np.ndarray:
    changed = affine.copy()
    changed[row, column] = value
    return changed


def _frames(count: int, voxels: Callable[[], np.ndarray] = sax) -> Callable[[], np.ndarray]:
    return lambda: np.stack([voxels()] * count, axis=-1)


def _floats(change: Callable[[np.ndarray], None]) -> Callable[[], np.ndarray]:
    def build() -> np.ndarray:
        labels = sax().astype(np.float32)
        change(labels)
        return labels

    return build


def _blurred(labels: np.ndarray) -> None:
    labels[1:] = (labels[1:] + labels[:-1]) / 2


def _one_nan(labels: np.ndarray) -> None:
    labels[5, 5, 5] = np.nan


def _one_slice() -> np.ndarray:
    labels = sax()
    labels[:, :, :7] = 0
    labels[:, :, 8:] = 0
    return labels


def _bomb() -> bytes:
    """An honest small map, then members of zeros: 256 MiB and more out of 300 kB."""
    return gz(nifti(sax(), SAX_AFFINE)) + gz(bytes(1 << 20)) * 260


def _pair(**views: Callable[[], bytes]) -> Callable[[], Mapping[str, bytes]]:
    return lambda: {view: data() for view, data in views.items()}


_IMAGE = np.random.default_rng(0).integers(0, 4000, SAX_SHAPE).astype(np.int16)
_TURN = np.radians(20.0)
_SHEARED = SAX_AFFINE @ np.array(
    [[1, np.tan(_TURN), 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]
)

CATALOGUE: tuple[LabelMapCase, ...] = (
    # what is no readable file
    _door("empty-file", lambda: b"", ProblemType.UNREADABLE_LABEL_MAP, "empty", "send a .nii"),
    _door("not-nifti", lambda: b"hello" * 200, ProblemType.UNREADABLE_LABEL_MAP, "send a .nii"),
    _door(
        "dicom",
        lambda: bytes(128) + b"DICM" + bytes(900),
        ProblemType.UNREADABLE_LABEL_MAP,
        "a DICOM file",
    ),
    _door(
        "header-cut-short",
        lambda: nifti(sax(), SAX_AFFINE)[:200],
        ProblemType.UNREADABLE_LABEL_MAP,
        "ends inside its 348-byte header",
    ),
    _door(
        "gzip-cut-short",
        lambda: _map()()[:-300],
        ProblemType.UNREADABLE_LABEL_MAP,
        "ends before its last block",
        "gzip -t",
    ),
    _door(
        "gzip-wrong-checksum",
        lambda: _map()()[:-8] + bytes(4) + _map()()[-4:],
        ProblemType.UNREADABLE_LABEL_MAP,
        "gzip -t",
    ),
    _door(
        "gzip-then-garbage",
        lambda: _map()() + b"garbage",
        ProblemType.UNREADABLE_LABEL_MAP,
        "not gzip",
    ),
    _door(
        "voxels-cut-short",
        lambda: nifti(sax(), SAX_AFFINE)[:-1000],
        ProblemType.UNREADABLE_LABEL_MAP,
        "export it anew",
    ),
    _door(
        "more-voxels-than-promised",
        _map(dim=[3, 64, 50, 8, 1, 1, 1, 1]),
        ProblemType.UNREADABLE_LABEL_MAP,
        "export it anew",
    ),
    _door(
        "fewer-voxels-than-promised",
        _map(dim=[3, 64, 50, 160, 1, 1, 1, 1]),
        ProblemType.UNREADABLE_LABEL_MAP,
        "export it anew",
    ),
    _door(
        "promises-18-gb",
        _map(dim=[3, 2500, 2400, 1500, 1, 1, 1, 1], data_type=64),
        ProblemType.TOO_LARGE,
        "crop it",
        status=413,
    ),
    _door(
        "dimensions-overflow",
        _map(version=2, dim=[3, 2**40, 2**40, 2**40, 1, 1, 1, 1]),
        ProblemType.TOO_LARGE,
        "crop it",
        status=413,
    ),
    _door(
        "negative-dimension",
        _map(dim=[3, 64, -50, 16, 1, 1, 1, 1]),
        ProblemType.UNREADABLE_LABEL_MAP,
        "64 x -50 x 16",
    ),
    _door("gzip-bomb", _bomb, ProblemType.TOO_LARGE, "inflates to more", status=413),
    _door(
        "too-many-frames",
        _map(_frames(65, lambda: np.zeros((8, 8, 4), np.uint8))),
        ProblemType.TOO_LARGE,
        "65 frames",
        "fewer frames",
        status=413,
    ),
    _door("negative-voxel-offset", _map(vox_offset=-16.0), ProblemType.UNREADABLE_LABEL_MAP),
    _door("voxels-in-the-header", _map(vox_offset=0.0), ProblemType.UNREADABLE_LABEL_MAP),
    # what is readable and no label map
    _door(
        "header-of-a-pair",
        lambda: nifti(sax(), SAX_AFFINE, magic=b"ni1\0")[:352],
        ProblemType.UNSUPPORTED_LABEL_MAP,
        "two-file NIfTI",
        "save a single file",
    ),
    _door(
        "analyze",
        lambda: nifti(sax(), SAX_AFFINE, magic=bytes(4))[:348],
        ProblemType.UNSUPPORTED_LABEL_MAP,
        "Analyze 7.5",
        "save a single file",
    ),
    _door(
        "one-channel-a-tissue",
        _map(lambda: np.zeros((*SAX_SHAPE, 1, 4), np.uint8)),
        ProblemType.UNSUPPORTED_LABEL_MAP,
        "64 x 50 x 16 x 1 x 4",
    ),
    _door(
        "two-dimensions",
        _map(lambda: sax()[:, :, 7]),
        ProblemType.UNSUPPORTED_LABEL_MAP,
        "x, y, 1",
    ),
    _door("rgb", _map(data_type=128), ProblemType.UNSUPPORTED_LABEL_MAP, "RGB", "uint8"),
    _door("complex", _map(data_type=32), ProblemType.UNSUPPORTED_LABEL_MAP, "complex64", "uint8"),
    _door("no-data-type", _map(data_type=7), ProblemType.UNREADABLE_LABEL_MAP),
    _worker(
        "interpolated-labels",
        _map(_floats(_blurred)),
        ProblemType.UNSUPPORTED_LABEL_MAP,
        "nearest neighbour",
    ),
    _worker("nan-voxels", _map(_floats(_one_nan)), ProblemType.UNSUPPORTED_LABEL_MAP, "NaN"),
    _worker("an-image", _map(lambda: _IMAGE), ProblemType.UNSUPPORTED_LABEL_MAP, "an image"),
    # where the voxels lie
    _door(
        "nan-affine",
        _map(affine=_with_element(SAX_AFFINE, 0, 0, np.nan), pixdim=(2, 2, 8)),
        ProblemType.INVALID_AFFINE,
        "NaN",
    ),
    _door(
        "singular-affine",
        _map(affine=_with_element(SAX_AFFINE, 2, 2, 0.0), pixdim=(2, 2, 8)),
        ProblemType.INVALID_AFFINE,
        "singular",
    ),
    _door(
        "sheared-affine", _map(affine=_SHEARED), ProblemType.INVALID_AFFINE, "sheared", "resample"
    ),
    _door(
        "no-unit-quaternion",
        _map(affine=None, pixdim=(2, 2, 8), quaternion=[0.9, 0.9, 0.9, 0, 0, 0]),
        ProblemType.INVALID_AFFINE,
        "quaternion",
    ),
    _door(
        "zero-pixdim",
        _map(pixdim=(0.0, 2.0, 8.0)),
        ProblemType.AMBIGUOUS_VOXEL_SIZE,
        "0 x 2 x 8",
        '`spacing: "affine"`',
    ),
    _door(
        "voxel-sizes-disagree",
        _map(pixdim=(1.4, 1.4, 10.0)),
        ProblemType.AMBIGUOUS_VOXEL_SIZE,
        "2 x 2 x 8 mm",
        "1.4 x 1.4 x 10 mm",
        '`spacing: "affine"`',
        '`spacing: "pixdim"`',
    ),
    LabelMapCase(
        "views-without-orientation",
        _pair(sax=_map(affine=None, pixdim=(2, 2, 8)), lax_4ch=_map(lax, LAX_AFFINE)),
        "door",
        ProblemType.INVALID_AFFINE,
        422,
        "sax",
        says=("short-axis stack alone",),
    ),
    LabelMapCase(
        "views-differ-in-frames",
        _pair(sax=_map(_frames(3)), lax_4ch=_map(_frames(2, lax), LAX_AFFINE)),
        "door",
        ProblemType.MISMATCHED_VIEWS,
        422,
        "lax_4ch",
        says=("2 frames", "3"),
    ),
    LabelMapCase(
        "views-in-different-places",
        _pair(sax=_map(), lax_4ch=_map(lax, _moved(LAX_AFFINE, 150.0))),
        "worker",
        ProblemType.MISMATCHED_VIEWS,
        422,
        "lax_4ch",
        says=("affine",),
    ),
    LabelMapCase(
        "wrong-number-of-frame-labels",
        _sax(_map(_frames(3))),
        "door",
        ProblemType.INVALID_REQUEST,
        422,
        "/frame_labels",
        {"subject_id": "bad", "label_scheme": "mnms", "frame_labels": ["ED", "ES"]},
        ("2 frame labels for 3 frames",),
    ),
    LabelMapCase(
        "wall-without-its-cavity",
        _sax(_map()),
        "door",
        ProblemType.INVALID_REQUEST,
        422,
        "/label_scheme/lv_cavity",
        {"subject_id": "bad", "label_scheme": {"lv_wall": [2], "ignored": [1, 3]}},
        ("label the cavity",),
    ),
    # what the labels say
    _worker(
        "no-label-at-all",
        _map(lambda: np.zeros(SAX_SHAPE, np.uint8)),
        ProblemType.EMPTY_LABEL_MAP,
        "leave this view out",
    ),
    _worker(
        "every-voxel-labelled",
        _map(lambda: np.ones(SAX_SHAPE, np.uint8)),
        ProblemType.UNSUPPORTED_LABEL_MAP,
        "background as 0",
    ),
    _worker(
        "all-one-label",
        _map(lambda: (sax() > 0).astype(np.uint8)),
        ProblemType.WRONG_LABEL_SCHEME,
        "no lv_wall",
        pointer="/label_scheme",
    ),
    _worker(
        "acdc-read-as-mnms",
        _map(lambda: renamed(sax(), ACDC_NAMES)),
        ProblemType.WRONG_LABEL_SCHEME,
        "`acdc`",
        pointer="/label_scheme",
    ),
    LabelMapCase(
        "mnms-read-as-acdc",
        _sax(_map()),
        "worker",
        ProblemType.WRONG_LABEL_SCHEME,
        422,
        "/label_scheme",
        {"subject_id": "bad", "label_scheme": "acdc"},
        ("`mnms`", "`ukbb`"),
    ),
    _worker(
        "unknown-labels",
        _map(lambda: renamed(sax(), {3: 9})),
        ProblemType.UNKNOWN_LABELS,
        "values 9,",
        "ignored",
        '"ignored":[9]',
        pointer="/label_scheme",
    ),
    _worker(
        "values-of-another-scheme",
        _map(lambda: renamed(sax(), {3: 4})),
        ProblemType.UNKNOWN_LABELS,
        "`digital_heart`",
        pointer="/label_scheme",
    ),
    _worker(
        "one-slice-only", _map(_one_slice), ProblemType.TOO_FEW_SLICES, "whole short-axis stack"
    ),
    # what looks wrong and is right
    LabelMapCase(
        "plain-nifti-whatever-its-name",
        _sax(lambda: nifti(sax(), SAX_AFFINE)),
        "accepted",
        None,
        202,
        None,
    ),
    LabelMapCase(
        "two-gzip-members",
        _sax(lambda: gz(nifti(sax(), SAX_AFFINE)[:5000]) + gz(nifti(sax(), SAX_AFFINE)[5000:])),
        "accepted",
        None,
        202,
        None,
    ),
    LabelMapCase(
        "big-endian-nifti-2-of-int32",
        _sax(_map(lambda: sax().astype(np.int32), version=2, order=">")),
        "accepted",
        None,
        202,
        None,
    ),
    LabelMapCase(
        "float64-with-trailing-singletons",
        _sax(_map(lambda: sax().astype(np.float64)[..., None, None])),
        "accepted",
        None,
        202,
        None,
    ),
    LabelMapCase(
        "unit-scale-sform-with-a-real-pixdim",
        _sax(_map(affine=np.diag([1.0, 1.0, 1.0, 1.0]), pixdim=(2.0, 2.0, 8.0))),
        "accepted",
        None,
        202,
        None,
    ),
)
