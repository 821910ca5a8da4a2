from pathlib import Path

import numpy as np
import pytest
import pyvista
import trimesh

from worker.artifacts.mesh_files.content import Content
from worker.artifacts.mesh_files.ply import write_ply

_TYPES = {"float": np.dtype("<f4"), "uchar": np.dtype("u1")}


@pytest.fixture
def path(content: Content, tmp_path: Path) -> Path:
    written = tmp_path / "ED_lv_endo.ply"
    write_ply(written, content)
    return written


def _header(path: Path) -> list[str]:
    return path.read_bytes().partition(b"end_header\n")[0].decode("ascii").splitlines()


def test_comments_say_whose_it_is_and_what_the_numbers_mean(path: Path, content: Content) -> None:
    comments = [line for line in _header(path) if line.startswith("comment ")]
    assert comments == [
        f"comment neuralmri units=mm axes=RAS name=ED_lv_endo job_id={content.job_id}",
        *(f"comment {field.described}" for field in content.fields),
    ]


def test_trimesh_reads_every_number_back(path: Path, content: Content) -> None:
    read = trimesh.load_mesh(path, process=False)
    stored = read.metadata["_ply_raw"]["vertex"]["data"]
    for field in content.fields:
        assert stored[field.name].dtype == field.values.dtype
        np.testing.assert_array_equal(stored[field.name], field.values)
    np.testing.assert_array_equal(read.vertices, content.mesh.vertices_mm.astype(np.float32))
    np.testing.assert_array_equal(read.faces, content.mesh.faces)


def test_a_plain_parser_reads_every_number_back(path: Path, content: Content) -> None:
    properties = [line.split()[1:] for line in _header(path) if line.startswith("property ")]
    vertex = np.dtype([(name, _TYPES[kind]) for kind, *_, name in properties if kind != "list"])
    body = path.read_bytes().partition(b"end_header\n")[2]
    count = len(content.mesh.vertices_mm)
    stored = np.frombuffer(body, vertex, count)
    for field in content.fields:
        np.testing.assert_array_equal(stored[field.name], field.values)
    faces = np.frombuffer(body[count * vertex.itemsize :], [("n", "u1"), ("corners", "<i4", 3)])
    assert set(faces["n"]) == {3}
    np.testing.assert_array_equal(faces["corners"], content.mesh.faces)


def test_vtk_reads_the_same_surface(path: Path, content: Content) -> None:
    read = pyvista.PLYReader(str(path)).read()
    np.testing.assert_array_equal(read.points, content.mesh.vertices_mm.astype(np.float32))
    np.testing.assert_array_equal(read.regular_faces, content.mesh.faces)
