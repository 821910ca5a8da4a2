import contextlib

import numpy as np
import pytest
import trimesh

from schemas.problem import InputError
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import is_outward
from worker.mesh_file import read_surface

PLY = (
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    b"property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    b"0 0 0\n1 0 0\n0 1 0\n%s\n"
)


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
        ("a.stl", b"", "is empty"),
        ("a.stl", b"solid x\nfoo", "send the whole file"),
        ("a.stl", bytes(84), "no triangles"),
        ("a.ply", b"garbage", "convert it"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n", "export it again"),
        ("a.obj", b"v 0 0 0\n", "no triangles"),
        ("a.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "no"),
        ("a.obj", b"v 1e300 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "beyond all bounds"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "again"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\n", "no triangles with an area"),
        ("a.ply", PLY % b"3 0 1 9", "again"),
        ("a.ply", PLY % b"3 0 1 -2", "again"),
        ("a.ply", PLY % b"3 0 1 1", "no triangles with an area"),
        ("a.ply", PLY % b"2 0 1   ", "no triangles"),
        ("a.vtk", b"# vtk DataFile Version 3.0\n", "convert it"),
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


@pytest.mark.parametrize("form", ["stl", "stl_ascii", "obj", "ply"])
def test_the_content_tells_the_format_whatever_the_file_is_called(tmp_path, form):
    path = tmp_path / "truth.bin"
    content = trimesh.creation.box((10.0, 10.0, 10.0)).export(file_type=form)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert volume_ml(read_surface(path)) == pytest.approx(1.0)


def test_quads_are_divided(tmp_path):
    corners = [(x, y, z) for x in (0, 10) for y in (0, 10) for z in (0, 10)]
    quads = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [
        f"f {a} {b} {c} {d}" for a, b, c, d in quads
    ]
    (tmp_path / "cube.obj").write_text("\n".join(lines))
    assert volume_ml(read_surface(tmp_path / "cube.obj")) == pytest.approx(1.0)


def test_materials_that_a_file_names_are_not_looked_for(tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr("trimesh.exchange.obj.parse_mtl", lambda *a, **k: opened.append(a) or {})
    monkeypatch.setattr(
        "trimesh.resolvers.FilePathResolver.get", lambda _, name: opened.append(name) or b""
    )
    (tmp_path / "secret.mtl").write_text("newmtl a\n")
    path = tmp_path / "heart.obj"
    box = trimesh.creation.box((10.0, 10.0, 10.0)).export(file_type="obj")
    path.write_text(f"mtllib secret.mtl\nusemtl a\n{box}")
    assert len(read_surface(path).faces) == 12
    ply = trimesh.creation.box((10.0, 10.0, 10.0)).export(file_type="ply", encoding="ascii")
    path.write_bytes(ply.replace(b"1.0\n", b"1.0\ncomment TextureFile secret.png\n", 1))
    assert len(read_surface(path).faces) == 12
    assert opened == []


def test_polygons_count_as_the_triangles_that_they_become(tmp_path):
    path = tmp_path / "fan.obj"
    corners = "".join(f"v {np.cos(t)} {np.sin(t)} 0\n" for t in np.linspace(0, 6, 10))
    path.write_text(f"{corners}f {' '.join(str(k + 1) for k in range(10))}\nf 1 2 3\n")
    with pytest.raises(InputError, match="9 triangles") as caught:
        read_surface(path, "reference_ED_epi", max_triangles=8)
    assert (caught.value.status, caught.value.pointer) == (413, "reference_ED_epi")


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(InputError, match=r"there is no file .*gone\.stl"):
        read_surface(tmp_path / "gone.stl")


@pytest.mark.parametrize("form", ["stl", "stl_ascii", "obj", "ply"])
def test_a_damaged_file_is_read_or_refused(tmp_path, form):
    """Few bytes changed anywhere: whatever is raised but InputError fails the test."""
    generator = np.random.default_rng(1)
    solid = trimesh.creation.icosphere(subdivisions=1, radius=20.0)
    whole = solid.export(file_type=form)
    content = np.frombuffer(whole if isinstance(whole, bytes) else whole.encode(), dtype=np.uint8)
    path = tmp_path / "damaged"
    for _ in range(60):
        damaged = content.copy()
        at = generator.integers(0, len(content), 3)
        damaged[at] = generator.integers(0, 256, 3) if form in ("stl", "ply") else content[at[::-1]]
        path.write_bytes(damaged.tobytes())
        with contextlib.suppress(InputError):
            assert len(read_surface(path).faces)
