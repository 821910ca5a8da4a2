"""A DICOM file of a caller: opened with bounds, and its elements taken as the bytes they are.

pydicom reads the structure. Values are not converted by it: its warnings quote what it finds, and
a patient's name is among it; and a contour's coordinates would each become an object.
"""

import io
import struct
import warnings
import zlib
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from intake.formats.clinical_faults import too_large, unreadable
from intake.formats.dicom_layout import PIXEL_DATA_GROUP, Encoding, check_layout
from schemas.problem import InputError, InternalError, ProblemType

if TYPE_CHECKING:
    from pydicom.dataset import Dataset
    from pydicom.tag import BaseTag

_PREAMBLE_BYTES = 128
_MAGIC = b"DICM"
_META_GROUP = 2
_FIRST_GROUP = 8
_MAX_META_BYTES = 1 << 16
_TRANSFER_SYNTAX = 0x00020010
_IMPLICIT, _EXPLICIT = "1.2.840.10008.1.2", "1.2.840.10008.1.2.1"
_DEFLATED = "1.2.840.10008.1.2.1.99"
_BIG_ENDIAN = "1.2.840.10008.1.2.2"
_FAMILY = "1.2.840.10008.1.2"
"""All transfer syntaxes of the standard; those of compressed pixels are explicit, little endian."""

SPECIFIC_CHARACTER_SET = 0x00080005
SOP_CLASS_UID = 0x00080016
SOP_INSTANCE_UID = 0x00080018

# What pydicom raises for structures that the walk before it let pass.
_MISREAD = (
    *(EOFError, OSError, ValueError, KeyError, TypeError, AttributeError, NotImplementedError),
    *(struct.error, RecursionError, LookupError, UnicodeError),
)


def is_dicom(data: bytes) -> bool:
    """Whether the file begins as PS3.10 says, or at once with a data set, as older exports do."""
    return _has_header(data) or _is_bare(data)


def read_dicom(
    data: bytes, file: str, entered: frozenset[int], max_inflated_bytes: int
) -> "Dataset":
    """The data set of a DICOM file up to its pixels; sequences in `entered` (tags) may be read.

    Raises:
        InputError: at `file`: no DICOM file, damaged, or more than the bounds allow.
        InternalError: pydicom is not installed.
    """
    if not is_dicom(data):
        raise unreadable(
            file,
            "is not a DICOM file: it has neither the letters DICM after a preamble nor a data set",
            "export it as a DICOM file with its header (PS3.10)",
        )
    if _has_header(data):
        syntax, start = _transfer_syntax(data, file)
    else:
        syntax, start = (_EXPLICIT if data[4:6].isalpha() else _IMPLICIT), 0
    encoding = Encoding(implicit=syntax == _IMPLICIT, little=syntax != _BIG_ENDIAN)
    body = data[start:]
    if syntax == _DEFLATED:
        body = _inflated(body, file, max_inflated_bytes)
    check_layout(body, encoding, entered, file)
    return _dataset(io.BytesIO(body), encoding, file, _is_pixels)


def raw(dataset: "Dataset", tag: int) -> bytes:
    """The value of an element as bytes; empty where there is none."""
    element = dataset.get_item(tag, keep_deferred=True) if tag in dataset else None
    value = None if element is None else element.value
    return value if isinstance(value, bytes) else b""


def text(dataset: "Dataset", tag: int) -> str:
    """The value as ASCII text, padding taken off."""
    return raw(dataset, tag).decode("ascii", "replace").strip(" \0\t\r\n")


def names(dataset: "Dataset", tag: int, character_set: str) -> str:
    """The value as text in the file's own character set; what is not of it is replaced."""
    return raw(dataset, tag).decode(character_set, "replace").strip(" \0\t\r\n")


def character_set(dataset: "Dataset") -> str:
    """Python's name of the character set; of several the last, Latin-1 where it is unknown."""
    from pydicom.charset import python_encoding

    said = text(dataset, SPECIFIC_CHARACTER_SET).split("\\")[-1].strip()
    return python_encoding.get(said, "latin-1")


def numbers(dataset: "Dataset", tag: int) -> NDArray[np.float64] | None:
    """The numbers of a decimal or integer string; None where it holds anything else, or nothing."""
    value = raw(dataset, tag)
    if not value.strip(b" \0"):
        return None
    try:
        found = np.array(value.strip(b" \0").split(b"\\"), dtype=np.float64)
    except ValueError:
        return None
    return found if np.isfinite(found).all() else None


def items(dataset: "Dataset", tag: int, file: str) -> Iterator["Dataset"]:
    """The items of a sequence, none where it is missing.

    Raises:
        InputError: at `file`, for something that is no sequence.
    """
    if tag not in dataset:
        return
    element = dataset.get_item(tag, keep_deferred=True)
    if element.VR not in ("SQ", None):
        raise _damaged(file, "has a value where there should be a sequence")
    try:
        found = list(dataset[tag].value or ())
    except _MISREAD as error:
        raise _damaged(file, "has a sequence that cannot be read") from error
    yield from found


def _has_header(data: bytes) -> bool:
    return data[_PREAMBLE_BYTES : _PREAMBLE_BYTES + len(_MAGIC)] == _MAGIC


def _is_bare(data: bytes) -> bool:
    """Whether it begins with an element that data sets begin with, little endian."""
    group, element = int.from_bytes(data[:2], "little"), int.from_bytes(data[2:4], "little")
    return len(data) >= 8 and group == _FIRST_GROUP and element <= SOP_INSTANCE_UID & 0xFFFF


def _transfer_syntax(data: bytes, file: str) -> tuple[str, int]:
    """The transfer syntax, and where the data set begins."""
    start = _PREAMBLE_BYTES + len(_MAGIC)
    head = data[start : start + _MAX_META_BYTES]
    stream = io.BytesIO(head)
    meta = _dataset(stream, Encoding(implicit=False, little=True), file, _is_past_meta)
    syntax = text(meta, _TRANSFER_SYNTAX)
    if not syntax.startswith(_FAMILY):
        raise unreadable(
            file,
            "does not say in a known transfer syntax how it is written",
            "export it as Explicit VR Little Endian",
        )
    return syntax, start + stream.tell()


def _inflated(body: bytes, file: str, max_bytes: int) -> bytes:
    inflater = zlib.decompressobj(-zlib.MAX_WBITS)
    try:
        inflated = inflater.decompress(body, max_bytes)
    except zlib.error as error:
        raise _damaged(file, "has deflated data that is damaged") from error
    if inflater.unconsumed_tail:
        raise too_large(
            file,
            f"The file inflates to more than {max_bytes} bytes",
            "send an RT Structure Set of the heart alone",
        )
    if not inflater.eof:
        raise _damaged(file, "has deflated data that ends early")
    return inflated


def _dataset(
    stream: io.BytesIO,
    encoding: Encoding,
    file: str,
    is_end: Callable[["BaseTag", str | None, int], bool],
) -> "Dataset":
    try:
        from pydicom.filereader import read_dataset
    except ImportError as error:
        raise InternalError(
            ProblemType.INTERNAL,
            "DICOM files cannot be read here: pydicom is not installed. Remedy: install "
            "neuralmri[service], or pydicom.",
        ) from error
    # They tell of values; what matters of them is judged here.
    warnings.filterwarnings("ignore", module=r"pydicom\.")
    try:
        return read_dataset(stream, encoding.implicit, encoding.little, stop_when=is_end)
    except _MISREAD as error:
        raise _damaged(file, "cannot be read as DICOM") from error


def _is_past_meta(tag: "BaseTag", _vr: str | None, _length: int) -> bool:
    return tag >> 16 != _META_GROUP


def _is_pixels(tag: "BaseTag", _vr: str | None, _length: int) -> bool:
    return tag >> 16 == PIXEL_DATA_GROUP


def _damaged(file: str, how: str) -> InputError:
    return unreadable(file, how, "the file is cut short or damaged; export it anew")
