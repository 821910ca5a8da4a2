"""The header of a PLY file, held against the bytes that follow it. Nothing of the mesh is read."""

import re
from dataclasses import dataclass
from typing import BinaryIO

from intake.mesh_faults import unreadable_mesh
from schemas.problem import InputError

_MAX_LINES = 1000
_MAX_LINE_BYTES = 4096
_CHUNK = 1 << 20
_SPARE_LINES = 64
"""Empty lines that an ASCII file may have beside its rows."""

_BYTES = {
    **dict.fromkeys(("char", "uchar", "int8", "uint8"), 1),
    **dict.fromkeys(("short", "ushort", "int16", "uint16"), 2),
    **dict.fromkeys(("int", "uint", "int32", "uint32", "float", "float32"), 4),
    **dict.fromkeys(("double", "float64"), 8),
}
_FORMAT = re.compile(r"format (ascii|binary_little_endian|binary_big_endian) 1\.0")
_ELEMENT = re.compile(r"element (\S+) (\d{1,18})")
_SCALAR = re.compile(rf"property ({'|'.join(_BYTES)}) \S+")
_LIST = re.compile(rf"property list ({'|'.join(_BYTES)}) ({'|'.join(_BYTES)}) (\S+)")
_LEAST_CORNERS = {"vertex_index": 3, "vertex_indices": 3}
"""What a list of this name holds at least; any other may be empty."""
_REMARK = re.compile(r"(comment|obj_info)\b.*")
_NOT_NUMBERS = re.compile(rb"[^0-9eEnNaAiIfF+\-. \t\r\n]")


@dataclass
class _Element:
    """What is counted in the header: how many rows, and what one takes at least."""

    rows: int
    values: int = 0
    bytes: int = 0


def count_ply_faces(file: BinaryIO, size: int, name: str) -> int:
    """How many faces a PLY file of `size` bytes has, whose bytes could hold all that it counts.

    Raises:
        InputError: `INVALID_REQUEST` at `name`.
    """
    file.seek(0)
    is_ascii, elements = _read_header(file, name)
    start = file.tell()
    for kind, element in elements.items():
        if element.rows and not element.values:
            raise _refused(name, f"counts {element.rows} of `{kind}`, which have no property")
    if is_ascii:
        _check_rows(file, elements, name)
        needed = sum(2 * e.values * e.rows for e in elements.values()) - 1
    else:
        needed = sum(e.bytes * e.rows for e in elements.values())
    if needed > size - start:
        counted = ", ".join(f"{element.rows} of `{kind}`" for kind, element in elements.items())
        raise _refused(
            name,
            f"counts {counted}, which take {needed} bytes or more, and has {size - start} after "
            "its header",
        )
    if "vertex" not in elements:
        raise _refused(name, "has no vertices")
    return elements["face"].rows if "face" in elements else 0


def _read_header(file: BinaryIO, name: str) -> tuple[bool, dict[str, _Element]]:
    """Whether the data are ASCII, and the elements by name; `file` then stands at the data."""
    _line(file)
    form = _FORMAT.fullmatch(_line(file))
    if form is None:
        raise _refused(name, "does not say its format in its second line")
    elements: dict[str, _Element] = {}
    for _ in range(_MAX_LINES):
        line = _line(file)
        if line == "end_header":
            return form[1] == "ascii", elements
        if _REMARK.fullmatch(line):
            continue
        if found := _ELEMENT.fullmatch(line):
            if found[1] in elements:
                raise _refused(name, f"counts `{found[1]}` twice")
            elements[found[1]] = latest = _Element(rows=int(found[2]))
        elif elements and (found := _SCALAR.fullmatch(line)):
            latest.values += 1
            latest.bytes += _BYTES[found[1]]
        elif elements and (found := _LIST.fullmatch(line)):
            items = _LEAST_CORNERS.get(found[3], 0)
            latest.values += 1 + items
            latest.bytes += _BYTES[found[1]] + items * _BYTES[found[2]]
        else:
            raise _refused(name, f"has a header line that is not understood ({line[:60]!r})")
    raise _refused(name, "has a header that does not end")


def _line(file: BinaryIO) -> str:
    return " ".join(file.readline(_MAX_LINE_BYTES).decode("ascii", "replace").split())


def _check_rows(file: BinaryIO, elements: dict[str, _Element], name: str) -> None:
    rows = sum(element.rows for element in elements.values())
    start, lines, last = file.tell(), 0, b"\n"
    while chunk := file.read(_CHUNK):
        if _NOT_NUMBERS.search(chunk):
            raise _refused(name, "has data that are no numbers")
        lines += chunk.count(b"\n")
        last = chunk[-1:]
    lines += last != b"\n"
    file.seek(start)
    if not rows <= lines <= rows + _SPARE_LINES:
        raise _refused(name, f"counts {rows} rows and has {lines} lines after its header")


def _refused(name: str, how: str) -> InputError:
    return unreadable_mesh(
        name, f"is no sound PLY file: it {how}", "export it again and send it whole"
    )
