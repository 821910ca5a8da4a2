import json

import numpy as np
import pytest
import trimesh
import typer
from typer.testing import CliRunner

from cli.slice import slice_
from schemas.problem import InputError
from schemas.study import ContourStudy
from schemas.vocabulary import Axes, Structure

app = typer.Typer()
app.command()(slice_)


def run(*arguments: object) -> str:
    result = CliRunner().invoke(app, [str(a) for a in arguments], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


@pytest.fixture
def folder(tmp_path):
    """Ellipsoids, 80 mm long along z and 40 mm wide, under several names."""
    solid = trimesh.creation.icosphere(subdivisions=4)
    solid.apply_scale((20.0, 20.0, 40.0))
    for name in ("lv_endo.ply", "ED_lv_endo.stl", "ES_lv_endo.stl", "odd.obj"):
        solid.export(tmp_path / name)
    return tmp_path


def study_of(path) -> ContourStudy:
    return ContourStudy.model_validate_json(path.read_text())


def test_an_ellipsoid_becomes_a_study_of_circles(folder):
    out = folder / "made" / "study.json"
    text = run(folder / "lv_endo.ply", "--out", out, "--spacing", 10, "--axis", 0, 0, 1)
    assert "ED: 11 slices" in text
    study = study_of(out)
    assert study.axes is Axes.LPS
    for one in study.frames[0].slices[:8]:
        (contour,) = one.contours
        points = np.array(contour.points)
        assert np.ptp(points[:, 2]) < 1e-3
        expected = 20.0 * np.sqrt(1.0 - (points[0, 2] / 40.0) ** 2)
        np.testing.assert_allclose(np.linalg.norm(points[:, :2], axis=1), expected, rtol=5e-3)


def test_frame_and_structure_come_from_the_file_name(folder):
    out = folder / "study.json"
    run(folder / "ED_lv_endo.stl", folder / "ES_lv_endo.stl", "--out", out, "--axes", "RAS")
    study = study_of(out)
    assert [f.label for f in study.frames] == ["ED", "ES"]
    assert study.axes is Axes.RAS


@pytest.mark.parametrize(
    ("name", "label", "structure"),
    [
        ("epi", "t00", Structure.EPI),
        ("lv_epi", "t00", Structure.LV_EPI),
        ("ES_rv_epi", "ES", Structure.RV_EPI),
        ("phase.3-epi", "phase.3", Structure.EPI),
        ("Lv_Endo", "t00", Structure.LV_ENDO),
    ],
)
def test_or_from_a_name_given_to_it(folder, name, label, structure):
    out = folder / "study.json"
    run(f"{name}={folder / 'odd.obj'}", "--out", out, "--frame", "t00", "--lax", 0)
    (frame,) = study_of(out).frames
    assert frame.label == label
    assert {c.structure for s in frame.slices for c in s.contours} == {structure}


def test_true_shifts_are_written_and_reproducible(folder):
    shifts = []
    for name in ("first", "second"):
        path = folder / f"{name}.json"
        run(
            *(folder / "lv_endo.ply", "--out", folder / "study.json", "--seed", 3),
            *("--shift-sd", 3, "--noise-sd", 0.3, "--shifts-out", path),
        )
        shifts.append(json.loads(path.read_text()))
    assert shifts[0] == shifts[1]
    assert np.linalg.norm(shifts[0]["sax-00"]) > 0.0
    assert shifts[0]["lax-00"] == [0.0, 0.0, 0.0]


def test_json_for_machines(folder):
    out = folder / "study.json"
    found = json.loads(run(folder / "lv_endo.ply", "--out", out, "--lax", 1, "--json"))
    assert found == {"study": str(out), "slices": {"ED": 11}}


@pytest.mark.parametrize(
    ("arguments", "remedy"),
    [
        (["odd.obj"], "write e.g. lv_endo="),
        (["lv_endo=nowhere.stl"], "check the path"),
        (["lv_endo.ply", "lv_endo=odd.obj"], "name its frame"),
        (["lv_endo.ply", "--spacing", "0"], "choose between"),
        (["lv_endo.ply", "--lax", "7"], "choose between"),
        (["lv_endo.ply", "--subject-id", "a/b"], "subject_id"),
        (["lv_endo.ply", "--axis", "0", "0", "0"], "zero vector"),
    ],
)
def test_bad_input_names_the_remedy(folder, monkeypatch, arguments, remedy):
    monkeypatch.chdir(folder)
    with pytest.raises(InputError, match=remedy):
        run(*arguments, "--out", "study.json")


def test_an_open_surface_is_refused(folder):
    solid = trimesh.creation.icosphere(subdivisions=3, radius=20.0)
    solid.update_faces(np.arange(len(solid.faces)) > 0)
    solid.export(folder / "lv_epi.stl")
    with pytest.raises(InputError, match="not closed"):
        run(folder / "lv_epi.stl", "--out", folder / "study.json")
