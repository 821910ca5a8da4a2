"""Which differences count between two runs, and which do not."""

import json
from pathlib import Path

import numpy as np
import pytest

from cli.same_results import Verdict, compare, version_differences
from schemas.report import Provenance
from schemas.vocabulary import Axes
from worker.artifacts.meshes import write_mesh
from worker.surface_mesh import SurfaceMesh

TETRAHEDRON = SurfaceMesh(
    vertices_mm=np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], dtype=np.float64),
    faces=np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.int64),
)
REPORT = {
    "subject_id": "a",
    "timings_s": {"total": 1.0},
    "provenance": {"software": "neuralmri 1", "python": "3.11", "libraries": {}, "seed": 0},
}


@pytest.fixture
def then(tmp_path: Path) -> Path:
    (tmp_path / "then").mkdir()
    return tmp_path / "then"


@pytest.fixture
def now(tmp_path: Path) -> Path:
    (tmp_path / "now").mkdir()
    return tmp_path / "now"


def write(folder: Path, name: str, content: str) -> None:
    (folder / name).write_text(content)


@pytest.mark.parametrize("form", ["stl", "obj", "ply"])
def test_a_mesh_is_the_same_geometry_whatever_it_says_of_its_job(
    form: str, then: Path, now: Path
) -> None:
    name = f"ED_lv_endo.{form}"
    for folder, job_id in ((then, "0" * 32), (now, None)):
        write_mesh(folder / name, TETRAHEDRON, "ED_lv_endo", Axes.LPS, job_id=job_id)
    found = compare(name, then, now)
    assert found.verdict is Verdict.SAME_GEOMETRY
    assert found.sha256_then != found.sha256_now
    assert compare(name, now, now).verdict is Verdict.SAME

    moved = SurfaceMesh(TETRAHEDRON.vertices_mm * 1.001, TETRAHEDRON.faces)
    write_mesh(now / name, moved, "ED_lv_endo", Axes.LPS, job_id="0" * 32)
    assert compare(name, then, now).verdict is Verdict.DIFFERENT


def test_a_report_is_the_same_but_for_time_and_versions(then: Path, now: Path) -> None:
    write(then, "report.json", json.dumps(REPORT))
    later = {**REPORT, "timings_s": {"total": 9.0}}
    later["provenance"] = {**REPORT["provenance"], "python": "3.12", "libraries": {"torch": "3"}}
    write(now, "report.json", json.dumps(later))
    assert compare("report.json", then, now).verdict is Verdict.SAME
    write(now, "report.json", json.dumps({**later, "subject_id": "b"}))
    assert compare("report.json", then, now).verdict is Verdict.DIFFERENT


def test_a_page_is_the_same_but_for_time_and_versions(then: Path, now: Path) -> None:
    page = "<tr><th>time</th><td>{}</td></tr><tr><th>seed</th><td>{}</td></tr>"
    write(then, "report.html", page.format("fitting 1 s", 0))
    write(now, "report.html", page.format("fitting 2 s", 0))
    assert compare("report.html", then, now).verdict is Verdict.SAME
    write(now, "report.html", page.format("fitting 2 s", 1))
    assert compare("report.html", then, now).verdict is Verdict.DIFFERENT


def test_what_only_one_run_made_is_not_the_same(then: Path, now: Path) -> None:
    write(then, "a.vtp", "a")
    write(now, "b.vtp", "b")
    missing, new = compare("a.vtp", then, now), compare("b.vtp", then, now)
    assert (missing.verdict, missing.sha256_now) == (Verdict.MISSING, None)
    assert (new.verdict, new.sha256_then) == (Verdict.NEW, None)
    assert not any(found.verdict.is_same for found in (missing, new))


def test_versions_that_differ_are_told() -> None:
    then = Provenance(
        software="neuralmri 0.1.0",
        python="3.11.7",
        libraries={"torch": "2.13.0", "igl": "1"},
        seed=0,
        threads=1,
        input_sha256="0",
    )
    assert version_differences(then, then) == []
    now = then.model_copy(update={"libraries": {"torch": "2.14.0"}, "software": "neuralmri 0.2.0"})
    told = {found.name: (found.then, found.now) for found in version_differences(then, now)}
    assert told == {
        "torch": ("2.13.0", "2.14.0"),
        "igl": ("1", None),
        "neuralmri": ("0.1.0", "0.2.0"),
    }
