from dataclasses import replace
from pathlib import Path

import numpy as np

from schemas.vocabulary import Axes
from worker.artifacts.mesh_files.content import Content
from worker.artifacts.mesh_files.obj import write_obj
from worker.surface_mesh import SurfaceMesh


def test_comments_say_whose_it_is_before_the_first_vertex(content: Content, tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    write_obj(path, content)
    lines = path.read_text().splitlines()
    assert lines[:6] == [
        "# neuralmri",
        "# units: mm",
        "# axes: RAS",
        "# name: ED_lv_endo",
        f"# job_id: {content.job_id}",
        "o ED_lv_endo",
    ]
    assert lines[6].startswith("v ")
    write_obj(path, replace(content, job_id=None))
    assert "job" not in path.read_text()


def test_zero_is_spelled_one_way(tmp_path: Path) -> None:
    vertices_mm = np.array([[-1e-9, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    path = tmp_path / "sheet.obj"
    sheet = SurfaceMesh(vertices_mm, np.array([[0, 1, 2]]))
    write_obj(path, Content(sheet, "sheet", Axes.LPS, None, []))
    assert "-0.000000" not in path.read_text()
