from dataclasses import replace
from pathlib import Path

import numpy as np
import pyvista

from worker.artifacts.mesh_files.content import Content
from worker.artifacts.mesh_files.vtp import write_vtp


def _read(content: Content, path: Path) -> pyvista.PolyData:
    write_vtp(path, content)
    return pyvista.XMLPolyDataReader(str(path)).read()


def test_every_number_comes_back_in_its_type(content: Content, tmp_path: Path) -> None:
    surface = _read(content, tmp_path / "a.vtp")
    assert surface.point_data.keys() == [field.name for field in content.fields]
    for field in content.fields:
        assert surface.point_data[field.name].dtype == field.values.dtype
        np.testing.assert_array_equal(surface.point_data[field.name], field.values)
    np.testing.assert_allclose(surface.points, content.mesh.vertices_mm, atol=1e-5)
    np.testing.assert_array_equal(surface.regular_faces, content.mesh.faces)


def test_field_data_says_whose_it_is_and_what_the_numbers_mean(
    content: Content, tmp_path: Path
) -> None:
    said = _read(content, tmp_path / "a.vtp").field_data
    for key, value in content.facts().items():
        assert list(said[key]) == [value]
    assert list(said["fields"]) == [field.described for field in content.fields]


def test_without_job_and_numbers_it_speaks_of_neither(content: Content, tmp_path: Path) -> None:
    surface = _read(replace(content, job_id=None, fields=[]), tmp_path / "a.vtp")
    assert sorted(surface.field_data.keys()) == ["axes", "name", "units"]
    assert not surface.point_data.keys()
