import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from schemas.vocabulary import Axes
from worker.artifacts.mesh_files.content import Content
from worker.artifacts.mesh_files.stl import write_stl
from worker.surface_mesh import SurfaceMesh


def _header(content: Content, path: Path) -> str:
    write_stl(path, content)
    return path.read_bytes()[:80].decode("ascii")


def test_the_header_holds_everything_of_a_job(content: Content, tmp_path: Path) -> None:
    header = _header(content, tmp_path / "a.stl")
    assert not header.startswith("solid")
    assert header.split() == [
        "neuralmri",
        "units=mm",
        "axes=RAS",
        f"job_id={content.job_id}",
        "ED_lv_endo",
    ]


@pytest.mark.parametrize("job_id", [None, "0193b5c8a1f27d0e9c4b6a8d2e1f3057", "j" * 36, "j" * 90])
@pytest.mark.parametrize("name", ["lv", "ED_lv_endo", "frame" * 12 + "_lv_endo"])
def test_whatever_is_long_the_file_has_the_length_its_count_promises(
    job_id: str | None, name: str, content: Content, tmp_path: Path
) -> None:
    path = tmp_path / "a.stl"
    header = _header(replace(content, job_id=job_id, name=name), path)
    data = path.read_bytes()
    (count,) = struct.unpack("<I", data[80:84])
    assert count == len(content.mesh.faces)
    assert len(data) == 84 + 50 * count
    assert header.startswith("neuralmri units=mm axes=RAS ")


def test_of_a_long_name_the_structure_is_kept(content: Content, tmp_path: Path) -> None:
    header = _header(replace(content, name="frame" * 12 + "_lv_endo"), tmp_path / "a.stl")
    assert f"job_id={content.job_id}" in header
    assert header.endswith("_lv_endo")


def test_a_degenerate_triangle_gets_a_zero_normal_not_nan(tmp_path: Path) -> None:
    flat = SurfaceMesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    path = tmp_path / "flat.stl"
    write_stl(path, Content(flat, "flat", Axes.LPS, None, []))
    assert struct.unpack("<3f", path.read_bytes()[84:96]) == (0.0, 0.0, 0.0)
