from pathlib import Path

import numpy as np
import pytest
import pyvista
import trimesh

from schemas.media_types import MESH_MEDIA_TYPES
from schemas.problem import InternalError
from schemas.vocabulary import Axes, MeshFormat
from worker.artifacts.meshes import write_mesh
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


def test_every_format_has_a_media_type() -> None:
    assert set(MESH_MEDIA_TYPES) == set(MeshFormat)


@pytest.mark.parametrize("form", list(MeshFormat))
def test_every_format_says_units_axes_name_and_job(
    form: MeshFormat, ellipsoid: SurfaceMesh, tmp_path: Path
) -> None:
    path = tmp_path / f"ED_lv_endo.{form}"
    write_mesh(path, ellipsoid, "ED_lv_endo", Axes.RAS, job_id="0193b5c8a1f27d0e9c4b6a8d2e1f3057")
    if form is MeshFormat.VTP:  # holds its strings compressed
        field_data = pyvista.XMLPolyDataReader(str(path)).read().field_data
        said = " ".join(str(field_data[key][0]) for key in field_data)
    else:
        said = path.read_bytes().decode("ascii", errors="replace")
    for word in ("mm", "RAS", "ED_lv_endo", "0193b5c8a1f27d0e9c4b6a8d2e1f3057"):
        assert word in said


@pytest.mark.parametrize("form", list(MeshFormat))
def test_what_is_no_number_is_written_in_no_format(
    form: MeshFormat, ellipsoid: SurfaceMesh, tmp_path: Path
) -> None:
    path = tmp_path / f"ED_lv_endo.{form}"
    broken = _number_at_vertices(ellipsoid)
    broken[7] = np.nan
    with pytest.raises(InternalError, match="support_mm is not finite at 1 vertices"):
        write_mesh(path, ellipsoid, path.stem, Axes.LPS, {"support_mm": broken})
    torn = SurfaceMesh(ellipsoid.vertices_mm * broken[:, None], ellipsoid.faces)
    with pytest.raises(InternalError, match="ED_lv_endo has vertices that are no numbers"):
        write_mesh(path, torn, path.stem, Axes.LPS)
    assert not path.exists()
