"""Which format a mesh file is in, and whether it can hold the triangles that it promises.

The content decides, never a name. Files are read in small pieces, and what a header counts is held
against the file's bytes, so that whoever reads the mesh afterwards cannot be made to allocate more
than the file is worth.
"""

import os
import re
from typing import BinaryIO

from intake.mesh_faults import refuse_triangles, unreadable_mesh
from intake.ply_header import count_ply_faces
from schemas.vocabulary import MeshFormat

_HEAD_BYTES = 1 << 16
"""How far to look for the first word of a text format."""
_CHUNK = 1 << 20
_STL_HEADER = 84
_STL_TRIANGLE = 50
_MAX_PARTS = 256
"""Solids of an STL file, or changes of material of an OBJ file: a surface is one."""

_NOT_TEXT = re.compile(rb"[\x00-\x08\x0e-\x1f\x7f]")
_OBJ_START = re.compile(
    rb"(?:\xef\xbb\xbf)?(?:\s|#[^\n]*\n)*+(?:v|vt|vn|vp|f|l|p|o|g|s|mtllib|usemtl)\s"
)


def check_mesh_file(file: BinaryIO, name: str, max_triangles: int) -> MeshFormat:
    """The format of a mesh file: STL (binary or ASCII), OBJ or PLY.

    Args:
        file: Can seek; is read from its start.
        name: Of the file part or file, for what is raised.
        max_triangles: How many the mesh may have, polygons counted once.

    Raises:
        InputError: `INVALID_REQUEST` at `name` for a file that is empty, of another format, cut
            short or without triangles; `TOO_LARGE` (413).
    """
    size = file.seek(0, os.SEEK_END)
    if not size:
        raise unreadable_mesh(name, "is empty", "send the mesh itself, as STL, OBJ or PLY")
    file.seek(0)
    head = file.read(_HEAD_BYTES)
    form, triangles = _recognised(file, head, size, name)
    if not triangles:
        raise unreadable_mesh(
            name,
            f"is {form.upper()} and has no triangles",
            "export the surface, not points or lines",
        )
    refuse_triangles(name, triangles, max_triangles)
    return form


def _recognised(file: BinaryIO, head: bytes, size: int, name: str) -> tuple[MeshFormat, int]:
    # First, and by its exact size: the text of a binary STL's header may begin with any word.
    promised = int.from_bytes(head[_STL_HEADER - 4 : _STL_HEADER], "little")
    if size == _STL_HEADER + _STL_TRIANGLE * promised:
        return MeshFormat.STL, promised
    if re.match(rb"ply\r?\n", head):
        return MeshFormat.PLY, count_ply_faces(file, size, name)
    if not _NOT_TEXT.search(head):
        if head.lstrip()[:5].lower() == b"solid":
            return MeshFormat.STL, _ascii_stl_triangles(file, name)
        if _OBJ_START.match(head):
            return MeshFormat.OBJ, _obj_faces(file, name)
        raise unreadable_mesh(name, "is no STL, OBJ or PLY file", "convert it to one of them")
    raise unreadable_mesh(
        name,
        "is no STL, OBJ or PLY file, or is cut short (as a binary STL it would have "
        f"{promised} triangles in {_STL_HEADER + _STL_TRIANGLE * promised} bytes, and it has "
        f"{size})",
        "send the whole file, uncompressed, in one of these formats",
    )


def _ascii_stl_triangles(file: BinaryIO, name: str) -> int:
    ends = _count(file, b"endsolid")
    if not ends:
        raise unreadable_mesh(
            name, "is an ASCII STL without its end (`endsolid`)", "send the whole file"
        )
    _refuse_parts(name, ends, "solids")
    return _count(file, b"vertex") // 3


def _obj_faces(file: BinaryIO, name: str) -> int:
    _refuse_parts(name, _count(file, b"usemtl"), "changes of material")
    return _count(file, b"\nf ")


def _refuse_parts(name: str, found: int, what: str) -> None:
    if found > _MAX_PARTS:
        raise unreadable_mesh(
            name, f"has {found} {what}", "export one surface, as one part and without materials"
        )


def _count(file: BinaryIO, word: bytes) -> int:
    """How often `word`, in small letters, stands in the file, whose first line follows a newline.

    For words that cannot overlap themselves.
    """
    file.seek(0)
    found, end = 0, b"\n"
    while chunk := file.read(_CHUNK):
        text = end + chunk.lower()
        found += text.count(word)
        end = text[-(len(word) - 1) :]
    return found
