"""Mesh files at the door: what each format must be, and what no file can make us allocate."""

import struct
import tracemalloc
from io import BytesIO

import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from intake.mesh_header import check_mesh_file
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import MeshFormat

BALL = trimesh.creation.icosphere(subdivisions=2, radius=20.0)
TRIANGLES = len(BALL.faces)


def exported(kind: str) -> bytes:
    content = BALL.export(file_type=kind)
    return content.encode() if isinstance(content, str) else content


ASCII_STL = exported("stl_ascii")
BINARY_STL = exported("stl")
OBJ = exported("obj")
BINARY_PLY = exported("ply")
ASCII_PLY = BALL.export(file_type="ply", encoding="ascii")

HEADER = (
    b"ply\nformat %s 1.0\ncomment by hand\nelement vertex %d\nproperty float x\n"
    b"property float y\nproperty float z\nelement face %d\n"
    b"property list uchar int vertex_indices\nend_header\n"
)


def judged(content: bytes, max_triangles: int = 10**6) -> MeshFormat:
    return check_mesh_file(BytesIO(content), "reference_ED_lv_endo", max_triangles)


def refusal(content: bytes, max_triangles: int = 10**6) -> InputError:
    with pytest.raises(InputError) as caught:
        judged(content, max_triangles)
    assert caught.value.pointer == "reference_ED_lv_endo"
    assert "Remedy" in caught.value.detail
    return caught.value


@pytest.mark.parametrize(
    ("content", "form"),
    [
        (BINARY_STL, MeshFormat.STL),
        (b"solid by a liar".ljust(80) + BINARY_STL[80:], MeshFormat.STL),
        (ASCII_STL, MeshFormat.STL),
        (ASCII_STL.upper(), MeshFormat.STL),
        (ASCII_STL.replace(b"\n", b"\r\n"), MeshFormat.STL),
        (OBJ, MeshFormat.OBJ),
        (b"# by hand\r\n\r\no heart\r\n" + OBJ.replace(b"\n", b"\r\n"), MeshFormat.OBJ),
        (b"\xef\xbb\xbf# K\xc3\xb6rper\n" + OBJ, MeshFormat.OBJ),
        (BINARY_PLY, MeshFormat.PLY),
        (ASCII_PLY, MeshFormat.PLY),
        (ASCII_PLY + b"\n\n", MeshFormat.PLY),
        (ASCII_PLY.rstrip(b"\n"), MeshFormat.PLY),
        (BINARY_PLY.replace(b"ply\n", b"ply\r\n", 1), MeshFormat.PLY),
    ],
)
def test_the_content_tells_the_format(content: bytes, form: MeshFormat) -> None:
    assert judged(content) is form


@pytest.mark.parametrize("content", [BINARY_STL, ASCII_STL, OBJ, BINARY_PLY, ASCII_PLY])
def test_as_many_triangles_as_the_limit_and_no_more(content: bytes) -> None:
    judged(content, TRIANGLES)
    error = refusal(content, TRIANGLES - 1)
    assert (error.type, error.status) == (ProblemType.TOO_LARGE, 413)
    assert f"{TRIANGLES} triangles" in error.detail


def ply(vertices: int, faces: int, form: bytes = b"binary_little_endian") -> bytes:
    return HEADER % (form, vertices, faces)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "is empty"),
        (b"\n \n", "convert it"),
        (b"a patient's letter\n", "convert it"),
        (b"# vtk DataFile Version 3.0\nheart\nASCII\nDATASET POLYDATA\n", "convert it"),
        (b"<?xml version='1.0'?><VTKFile type='PolyData'>", "convert it"),
        (b"\x1f\x8b" + BINARY_PLY, "uncompressed"),
        (bytes(84), "no triangles"),
        (bytes(83), "cut short"),
        (BINARY_STL[:-1], "cut short"),
        (BINARY_STL + b"\n", "cut short"),
        (bytes(80) + struct.pack("<I", 2**32 - 1) + bytes(50), "4294967295 triangles"),
        (ASCII_STL[:-40], "endsolid"),
        (b"solid\nendsolid\n", "no triangles"),
        (b"solid\nendsolid\n" * 300, "300 solids"),
        (b"v 0 0 0\nv 1 0 0\n", "no triangles"),
        (OBJ + b"usemtl a\nusemtl b\n" * 150, "300 changes of material"),
        (ply(10**9, 10**9), "counts 1000000000 of `vertex`"),
        (ply(10**9, 10**9, b"ascii"), "has 0 lines"),
        (ply(3, 0) + bytes(36), "no triangles"),
        (BINARY_PLY[:-2000], "after its header"),
        (ASCII_PLY[:-2000], "lines"),
        (ASCII_PLY + b"\n" * 1000, "lines"),
        (ASCII_PLY + b"\x1c", "no numbers"),
        (ply(3, 1, b"ternary"), "second line"),
        (b"ply\ncomment first\nformat ascii 1.0\n", "second line"),
        (ply(3, 1).replace(b"float x", b"quaternion x"), "not understood ('property quaternion"),
        (ply(3, 1).replace(b"element face 1", b"element face -1"), "not understood"),
        (ply(3, 1).replace(b"element face 1", b"element vertex 1"), "twice"),
        (ply(3, 1).replace(b"element face 1", b"element ghost 9\nelement face 1"), "no property"),
        (b"ply\nformat ascii 1.0\nproperty float x\n", "not understood"),
        (b"ply\nformat ascii 1.0\n", "not understood"),
        (b"ply\nformat ascii 1.0\n" + b"comment\n" * 2000, "does not end"),
        (b"ply\nformat ascii 1.0\nelement face 1\nproperty int a\nend_header\n1", "no vertices"),
    ],
)
def test_what_is_no_whole_surface_is_refused_with_the_remedy(content: bytes, said: str) -> None:
    error = refusal(content)
    assert said in error.detail
    assert error.type is ProblemType.INVALID_REQUEST


@pytest.mark.parametrize(
    "content",
    [
        bytes(80) + struct.pack("<I", 2**32 - 1) + bytes(50),
        ply(10**9, 10**9) + bytes(1000),
        ply(10**9, 10**9, b"ascii") + b"0 0 0\n" * 100,
        b"ply\nformat ascii 1.0\nelement vertex " + b"9" * 200_000,
        b" " * 200_000,
        b"#" * 200_000,
        b"solid" * 40_000,
    ],
)
def test_no_promise_makes_it_allocate(content: bytes) -> None:
    tracemalloc.start()
    try:
        refusal(content)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 8 * 2**20


WORDS = (
    *(b"ply\n", b"format ascii 1.0\n", b"format binary_big_endian 1.0\n", b"end_header\n"),
    *(b"element vertex 3\n", b"element face 1\n", b"property float x\n"),
    *(b"property list uchar int vertex_index\n", b"solid", b"endsolid", b"vertex 0 0 0\n"),
    *(b"v 0 0 0\n", b"f 1 2 3\n", b"usemtl x\n", b"#\n"),
)


def verdict(content: bytes) -> str:
    """Accepted, or refused with a problem: whatever else is raised fails the test."""
    try:
        return judged(content)
    except InputError as error:
        return error.detail


@settings(max_examples=300, deadline=None)
@given(
    st.one_of(st.binary(max_size=300), st.lists(st.sampled_from(WORDS), max_size=30).map(b"".join))
)
def test_any_bytes_are_judged(content: bytes) -> None:
    said = verdict(content)
    assert said in ("stl", "obj", "ply") or "Remedy" in said


@settings(max_examples=200, deadline=None)
@given(
    st.sampled_from([BINARY_STL, ASCII_STL, OBJ, BINARY_PLY, ASCII_PLY]),
    st.integers(0, 600),
    st.binary(max_size=40),
)
def test_any_damage_is_judged(content: bytes, at: int, put: bytes) -> None:
    said = verdict(content[:at] + put + content[at + len(put) :])
    assert said in ("stl", "obj", "ply") or "Remedy" in said
