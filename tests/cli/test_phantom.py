import json

import pytest
import typer
from typer.testing import CliRunner

from cli.phantom import phantom
from schemas.messages import ContourRequest
from schemas.problem import InputError
from schemas.study import ContourStudy
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import euler_number, is_outward
from worker.mesh_file import read_surface

app = typer.Typer()
app.command()(phantom)

SURFACES = [
    f"{frame}_{name}" for frame in ("ED", "ES") for name in ("lv_endo", "lv_epi", "rv_endo")
]


def run(*arguments: object) -> str:
    result = CliRunner().invoke(app, [str(a) for a in arguments], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("phantom") / "new"
    run("--out", out, "--edge", 2, "--shift-sd", 2, "--seed", 4, "--point-spacing", 3)
    return out


def test_it_writes_what_it_says(folder):
    expected = {f"{name}.stl" for name in SURFACES} | {"study.json", "request.json", "truth.json"}
    assert {path.name for path in folder.iterdir()} == expected


@pytest.mark.parametrize("name", SURFACES)
def test_surfaces_survive_the_file_and_have_the_volume_told(folder, name):
    mesh = read_surface(folder / f"{name}.stl")
    assert is_outward(mesh)
    assert euler_number(mesh) == 2
    frame, _, structure = name.partition("_")
    truth = json.loads((folder / "truth.json").read_text())["frames"][frame]["surfaces"][structure]
    assert volume_ml(mesh) == pytest.approx(truth["volume_ml"], rel=1e-5)
    if truth["closed_form_volume_ml"] is not None:
        assert truth["volume_ml"] == pytest.approx(truth["closed_form_volume_ml"], rel=6e-3)


def test_the_study_is_ready_to_post(folder):
    study = ContourStudy.model_validate_json((folder / "study.json").read_text())
    request = ContourRequest.model_validate_json((folder / "request.json").read_text())
    assert request.study == study
    assert [f.label for f in study.frames] == ["ED", "ES"]


def test_the_truth_has_function_and_shifts(folder):
    truth = json.loads((folder / "truth.json").read_text())
    assert 55.0 < truth["function"]["lv_ejection_fraction_percent"] < 60.0
    assert any(truth["true_shifts_mm"]["sax-03"])
    assert truth["slicing"]["seed"] == 4


def test_the_shape_can_be_chosen(tmp_path):
    found = json.loads(
        run(
            *(
                "--out",
                tmp_path,
                "--edge",
                3,
                "--shape",
                "wall_mm=14",
                "--shape",
                "lv_radius_mm=20",
            ),
            *("--format", "ply", "--json", "--lax", 1),
        )
    )
    assert found["shape"]["wall_mm"] == 14.0
    assert found["frames"]["ED"]["surfaces"]["lv_endo"]["volume_ml"] < 90.0
    assert (tmp_path / "ES_rv_endo.ply").is_file()


@pytest.mark.parametrize(
    ("arguments", "remedy"),
    [
        (["--shape", "wall_mm"], "NAME=VALUE"),
        (["--shape", "heads=2"], "choose of lv_radius_mm"),
        (["--shape", "wall_mm=99"], "choose between 4 and 20"),
        (["--edge", "0.001"], "choose between"),
        (["--spacing", "900"], "choose between"),
        (["--subject-id", "../x"], "subject_id"),
    ],
)
def test_bad_input_names_the_remedy(tmp_path, arguments, remedy):
    out = tmp_path / "never"
    with pytest.raises(InputError, match=remedy):
        run("--out", out, "--edge", "3", *arguments)
    assert not out.exists()
