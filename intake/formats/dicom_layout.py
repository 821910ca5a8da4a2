"""Where the elements of a DICOM data set lie: walked, counted and bounded before any is read.

A reader of DICOM makes an object of every element and of every item, and calls itself for every
level; a file of many megabytes of empty items would cost gigabytes.
"""

from dataclasses import dataclass
from struct import Struct
from typing import Literal

from intake.formats.clinical_faults import too_large, unreadable
from schemas.problem import InputError

MAX_ELEMENTS = 300_000
"""Elements of one file, items too: eight a contour are usual."""

MAX_ITEMS = 50_000
"""Items of one file, two a contour are usual. pydicom takes 50 microseconds for each."""

MAX_DEPTH = 16

PIXEL_DATA_GROUP = 0x7FE0

_UNDEFINED = 0xFFFFFFFF
_ITEM, _ITEM_END, _SEQUENCE_END = 0xFFFEE000, 0xFFFEE00D, 0xFFFEE0DD
_LONG = frozenset(
    (b"OB", b"OD", b"OF", b"OL", b"OV", b"OW", b"SQ", b"SV", b"UC", b"UN", b"UR", b"UT", b"UV")
)
"""Value representations with a length of four bytes (PS3.5, 7.1.2)."""


@dataclass(frozen=True)
class Encoding:
    """How the elements after the file's meta information are written."""

    implicit: bool
    little: bool


@dataclass(frozen=True)
class _Level:
    """A data set (of items: a sequence), up to `end`, or to its delimiter where that is None."""

    of_items: bool
    end: int | None
    implicit: bool


def check_layout(body: bytes, encoding: Encoding, entered: frozenset[int], file: str) -> None:
    """Refuse a data set that ends early, is nested too deep or has too many elements.

    Sequences in `entered` (tags) and those without a length are looked into; others are passed
    over as a whole. Stops before pixel data.

    Raises:
        InputError: at `file`.
    """
    byte_order: Literal["little", "big"] = "little" if encoding.little else "big"
    header = Struct("<HHL" if encoding.little else ">HHL")
    levels = [_Level(False, len(body), encoding.implicit)]
    at = elements = items = 0
    if encoding.implicit and body[4:6].isalpha() and body[4:6].isupper():
        raise _damaged(file, "says implicit VR, and its elements are written with explicit VR")
    while levels:
        level = levels[-1]
        if level.end is not None and at >= level.end:
            if at > level.end:
                raise _damaged(file, "has an element that is longer than what holds it")
            levels.pop()
            continue
        elements += 1
        if elements > MAX_ELEMENTS or items > MAX_ITEMS:
            raise too_large(
                file,
                f"The file has more than {MAX_ELEMENTS} elements or {MAX_ITEMS} items",
                "send an RT Structure Set of the heart alone",
            )
        if at + 8 > len(body):
            raise _cut_short(file)
        group, element, length = header.unpack_from(body, at)
        tag = group << 16 | element
        representation = body[at + 4 : at + 6]
        at += 8
        if level.of_items:
            if tag == _SEQUENCE_END and level.end is None:
                levels.pop()
            elif tag == _ITEM:
                items += 1
                inner_end = None if length == _UNDEFINED else at + length
                levels.append(_nested(False, inner_end, level.implicit, levels, file))
            else:
                raise _damaged(file, "has a sequence that holds something else than items")
            continue
        if tag == _ITEM_END and level.end is None:
            levels.pop()
            continue
        if len(levels) == 1 and group == PIXEL_DATA_GROUP:
            return
        if not level.implicit:
            if not (representation.isalpha() and representation.isupper()):
                raise _damaged(file, "has an element without a value representation")
            if representation in _LONG:
                if at + 4 > len(body):
                    raise _cut_short(file)
                length = int.from_bytes(body[at : at + 4], byte_order)
                at += 4
            else:
                length = int.from_bytes(body[at - 2 : at], byte_order)
        if length == _UNDEFINED:
            if not level.implicit and representation not in (b"SQ", b"UN"):
                raise _damaged(file, "has a value without a length where there must be one")
            # A sequence of unknown representation is written with implicit VR (PS3.5, 6.2.2).
            implicit = level.implicit or representation == b"UN"
            levels.append(_nested(True, None, implicit, levels, file))
        elif at + length > len(body):
            raise _cut_short(file)
        elif tag in entered and (level.implicit or representation == b"SQ"):
            levels.append(_nested(True, at + length, level.implicit, levels, file))
        else:
            at += length


def _nested(
    of_items: bool, end: int | None, implicit: bool, levels: list[_Level], file: str
) -> _Level:
    if len(levels) > 2 * MAX_DEPTH:
        raise too_large(
            file,
            f"The file nests sequences more than {MAX_DEPTH} deep",
            "export it anew as a plain RT Structure Set",
        )
    return _Level(of_items, end, implicit)


def _cut_short(file: str) -> InputError:
    return _damaged(file, "ends within an element")


def _damaged(file: str, how: str) -> InputError:
    return unreadable(file, how, "the file is cut short or damaged; export it anew")
