import struct
from pathlib import Path

import numpy as np
import pytest
import pyvista
import trimesh

from schemas.vocabulary import Axes, MeshFormat
from worker.artifacts.meshes import MEDIA_TYPES, write_mesh
from worker.surface_mesh import SurfaceMesh


@pytest.fixture(scope="module")
def ellipsoid() -> SurfaceMesh:
    """Half axes 30, 20 and 10 mm round the point (100, -50, 25) mm."""
    sphere = trimesh.creation.icosphere(subdivisions=3)
    vertices_mm = sphere.vertices * [30.0, 20.0, 10.0] + [100.0, -50.0, 25.0]
    return SurfaceMesh(np.asarray(vertices_mm), np.asarray(sphere.faces, dtype=np.int64))


def _loaded_mm(path: Path) -> trimesh.Trimesh:
    if path.suffix == ".vtp":
        surface = pyvista.XMLPolyDataReader(str(path)).read()
        return trimesh.Trimesh(surface.points, surface.regular_faces, process=False)
    return trimesh.load_mesh(path, process=False)


@pytest.mark.parametrize("form", [f for f in MeshFormat if f is not MeshFormat.GLB])
def test_a_reader_gets_back_the_millimetres_that_were_written(
    form: MeshFormat, ellipsoid: SurfaceMesh, tmp_path: Path
) -> None:
    path = tmp_path / f"ED_lv_endo.{form}"
    write_mesh(path, ellipsoid, "ED_lv_endo", Axes.LPS)

    triangles_mm = _loaded_mm(path).triangles

    # Half a unit in the last place of a float32 near 128 is 4e-6 mm.
    np.testing.assert_allclose(triangles_mm, ellipsoid.triangles_mm, atol=1e-5)


@pytest.mark.parametrize("form", list(MeshFormat))
def test_the_same_mesh_is_the_same_bytes(
    form: MeshFormat, ellipsoid: SurfaceMesh, tmp_path: Path
) -> None:
    written = []
    for folder in ("one", "two"):
        path = tmp_path / folder / f"ED_lv_endo.{form}"
        path.parent.mkdir()
        write_mesh(path, ellipsoid, "ED_lv_endo", Axes.RAS)
        written.append(path.read_bytes())
    assert written[0] == written[1]


def _number_at_vertices(mesh: SurfaceMesh) -> np.ndarray:
    return np.linalg.norm(mesh.vertices_mm, axis=1) / 7.0


def test_a_number_at_every_vertex_comes_back_from_vtp(
    ellipsoid: SurfaceMesh, tmp_path: Path
) -> None:
    path, values = tmp_path / "ED_lv_endo.vtp", _number_at_vertices(ellipsoid)
    write_mesh(path, ellipsoid, path.stem, Axes.LPS, {"support_mm": values})
    surface = pyvista.XMLPolyDataReader(str(path)).read()
    assert surface.point_data.keys() == ["support_mm"]
    assert surface.point_data["support_mm"].dtype == np.float32
    np.testing.assert_array_equal(surface.point_data["support_mm"], values.astype(np.float32))
    np.testing.assert_allclose(surface.points, ellipsoid.vertices_mm, atol=1e-5)


def test_a_number_at_every_vertex_comes_back_from_ply(
    ellipsoid: SurfaceMesh, tmp_path: Path
) -> None:
    path, values = tmp_path / "ED_lv_endo.ply", _number_at_vertices(ellipsoid)
    write_mesh(path, ellipsoid, path.stem, Axes.LPS, {"support_mm": values})
    assert b"property float support_mm\n" in path.read_bytes()
    read = trimesh.load_mesh(path, process=False)
    stored = read.metadata["_ply_raw"]["vertex"]["data"]["support_mm"]
    np.testing.assert_array_equal(stored, values.astype(np.float32))
    np.testing.assert_allclose(read.triangles, ellipsoid.triangles_mm, atol=1e-5)
    # Another reader, of the same bytes.
    np.testing.assert_allclose(pyvista.PLYReader(str(path)).read().points, read.vertices)


@pytest.mark.parametrize("form", [MeshFormat.STL, MeshFormat.OBJ, MeshFormat.GLB])
def test_formats_without_numbers_at_vertices_are_the_same_bytes_with_them(
    form: MeshFormat, ellipsoid: SurfaceMesh, tmp_path: Path
) -> None:
    path = tmp_path / f"ED_lv_endo.{form}"
    write_mesh(path, ellipsoid, path.stem, Axes.LPS)
    plain = path.read_bytes()
    numbers = {"support_mm": _number_at_vertices(ellipsoid)}
    write_mesh(path, ellipsoid, path.stem, Axes.LPS, numbers)
    assert path.read_bytes() == plain


@pytest.mark.parametrize("form", [MeshFormat.STL, MeshFormat.OBJ, MeshFormat.PLY])
def test_the_file_says_its_units_and_axes(
    form: MeshFormat, ellipsoid: SurfaceMesh, tmp_path: Path
) -> None:
    path = tmp_path / f"ED_lv_endo.{form}"
    write_mesh(path, ellipsoid, "ED_lv_endo", Axes.RAS)
    head = path.read_bytes()[:200]
    assert b"mm" in head
    assert b"RAS" in head
    assert b"ED_lv_endo" in head


def test_vtp_says_its_units_and_axes(ellipsoid: SurfaceMesh, tmp_path: Path) -> None:
    path = tmp_path / "ED_lv_endo.vtp"
    write_mesh(path, ellipsoid, "ED_lv_endo", Axes.RAS)
    surface = pyvista.XMLPolyDataReader(str(path)).read()
    assert list(surface.field_data["units"]) == ["mm"]
    assert list(surface.field_data["axes"]) == ["RAS"]


def test_binary_stl_has_the_length_its_count_promises(
    ellipsoid: SurfaceMesh, tmp_path: Path
) -> None:
    path = tmp_path / f"{'long-frame-label' * 4}_lv_endo.stl"
    write_mesh(path, ellipsoid, path.stem, Axes.LPS)
    data = path.read_bytes()
    (count,) = struct.unpack("<I", data[80:84])
    assert not data.startswith(b"solid")
    assert count == len(ellipsoid.faces)
    assert len(data) == 84 + 50 * count


def test_a_degenerate_triangle_gets_a_zero_normal_not_nan(tmp_path: Path) -> None:
    flat = SurfaceMesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    path = tmp_path / "flat.stl"
    write_mesh(path, flat, "flat", Axes.LPS)
    assert struct.unpack("<3f", path.read_bytes()[84:96]) == (0.0, 0.0, 0.0)


def test_obj_spells_zero_one_way(tmp_path: Path) -> None:
    vertices_mm = np.array([[-1e-9, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    path = tmp_path / "sheet.obj"
    write_mesh(path, SurfaceMesh(vertices_mm, np.array([[0, 1, 2]])), "sheet", Axes.LPS)
    assert "-0.000000" not in path.read_text()


@pytest.mark.parametrize(
    ("axes", "head", "front"),
    [(Axes.LPS, (0, 0, 1), (0, -1, 0)), (Axes.RAS, (0, 0, 1), (0, 1, 0))],
)
def test_glb_is_in_metres_with_the_head_up_and_the_patient_facing_z(
    axes: Axes, head: tuple[int, ...], front: tuple[int, ...], tmp_path: Path
) -> None:
    corners_mm = np.array([[0, 0, 0], head, front], dtype=float) * 1000.0
    path = tmp_path / "corner.glb"
    write_mesh(path, SurfaceMesh(corners_mm, np.array([[0, 1, 2]])), "corner", axes)

    scene = trimesh.load_scene(path)

    corners_m = scene.to_mesh().vertices
    np.testing.assert_allclose(sorted(corners_m.tolist()), [[0, 0, 0], [0, 0, 1], [0, 1, 0]])
    ((matrix, _),) = (scene.graph[node] for node in scene.graph.nodes_geometry)
    assert np.linalg.det(matrix) == pytest.approx(1e-9), "a mirrored heart"


def test_every_format_has_a_media_type() -> None:
    assert set(MEDIA_TYPES) == set(MeshFormat)
