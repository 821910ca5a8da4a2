import numpy as np
import pytest
import trimesh

from cli.mesh_file import read_surface
from schemas.problem import InputError
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import is_outward


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "STL"])
def test_a_cube_is_read_with_its_vertices_merged(tmp_path, suffix):
    path = tmp_path / f"cube.{suffix}"
    trimesh.creation.box((10.0, 10.0, 10.0)).export(path, file_type=suffix.lower())
    mesh = read_surface(path)
    assert mesh.vertices_mm.shape == (8, 3)
    assert is_outward(mesh)
    assert volume_ml(mesh) == pytest.approx(1.0)


def test_a_closed_surface_facing_inward_is_turned(tmp_path):
    solid = trimesh.creation.box((10.0, 10.0, 10.0))
    solid.invert()
    solid.export(tmp_path / "cube.ply")
    assert is_outward(read_surface(tmp_path / "cube.ply"))


@pytest.mark.parametrize(
    ("name", "content", "remedy"),
    [
        ("a.stl", b"", "no triangles"),
        ("a.stl", b"solid x\nfoo", "no triangles"),
        ("a.stl", bytes(84), "no triangles"),
        ("a.ply", b"garbage", "export it again"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n", "export it again"),
        ("a.obj", b"v 0 0 0\n", "no triangles"),
        ("a.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "no"),
        ("a.vtk", b"", "convert it"),
    ],
)
def test_what_is_no_surface_is_refused_with_the_remedy(tmp_path, name, content, remedy):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=remedy):
        read_surface(tmp_path / name)


def test_bytes_at_random_are_refused_not_crashed_on(tmp_path):
    generator = np.random.default_rng(0)
    for suffix in ("stl", "obj", "ply"):
        path = tmp_path / f"noise.{suffix}"
        for _ in range(20):
            path.write_bytes(generator.bytes(2000))
            with pytest.raises(InputError):
                read_surface(path)


def test_a_cut_off_file_is_refused(tmp_path):
    for suffix in ("stl", "ply"):
        path = tmp_path / f"cut.{suffix}"
        trimesh.creation.icosphere(subdivisions=3).export(path)
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
        with pytest.raises(InputError):
            read_surface(path)
