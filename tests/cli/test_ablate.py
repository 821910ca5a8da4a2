"""`neuralmri ablate` as a user types it."""

import json
from pathlib import Path

import pytest
import pyvista
import typer
from typer.testing import CliRunner

from cli.ablate import ablate, parsed_levels
from schemas.messages import ContourRequest
from schemas.options import Options
from schemas.problem import InputError
from schemas.vocabulary import Axes, Structure
from worker.artifacts.meshes import write_mesh
from worker.phantom import heart
from worker.phantom.standard_study import standard_study

app = typer.Typer()
app.command()(ablate)

QUICK = Options.model_validate(
    {
        "preset": "fast",
        "levels": 2,
        "iterations_per_level": 60,
        "mesh": {"grid_mm": 4.0},
        "reference": {"samples": 1000, "curvature_edge_mm": None},
        "surfaces": ["lv_endo"],
    }
)


def run(*arguments: object) -> str:
    result = CliRunner().invoke(
        app, [str(a) for a in arguments], catch_exceptions=False, env={"COLUMNS": "200"}
    )
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A request for the phantom's left cavity, and its true surface."""
    path = tmp_path_factory.mktemp("ablate")
    request = ContourRequest(study=standard_study(edge_mm=3.0), options=QUICK)
    (path / "request.json").write_text(request.model_dump_json(exclude_unset=True))
    truth = heart(0.0).meshes(3.0)[Structure.LV_ENDO]
    write_mesh(path / "truth.stl", truth, "ED_lv_endo", Axes.LPS)
    return path


@pytest.mark.parametrize(
    ("text", "levels"),
    [("0..5", [0, 1, 2, 3, 4, 5]), ("3", [3]), ("5,0,2", [0, 2, 5]), ("0..1, 4", [0, 1, 4])],
)
def test_levels_as_a_person_writes_them(text: str, levels: list[int]) -> None:
    assert parsed_levels(text) == levels


@pytest.mark.parametrize("text", ["", "all", "0-5", "5..0", "-1", "1,,2", "0..", "1.5", "100"])
def test_levels_that_are_none_are_refused_with_the_way_to_write_them(text: str) -> None:
    with pytest.raises(InputError, match=r"write FIRST..LAST as in 0..5"):
        parsed_levels(text)


@pytest.mark.parametrize(
    ("arguments", "remedy"),
    [
        (["--levels", "0..2"], "no level 2 in a fit of 2; choose from 0 to 1"),
        (["--levels", "many"], "write FIRST..LAST"),
        (["--reference", "{folder}/truth.stl"], "names no surface"),
        (["--reference", "ED_lv_endo=nowhere.stl"], "no file nowhere"),
        (["--reference", "ES_lv_endo={folder}/truth.stl"], "no frame ES.*frame of the study"),
        (["--reference", "ED_lv_endo={folder}/truth.stl"] * 2, "second reference of ED_lv_endo"),
    ],
)
def test_bad_input_names_the_remedy_before_anything_is_fitted(
    arguments: list[str], remedy: str, folder: Path, tmp_path: Path
) -> None:
    given = [argument.format(folder=folder) for argument in arguments]
    with pytest.raises(InputError, match=remedy):
        run(folder / "request.json", "--out", tmp_path / "out", *given)
    assert not list(tmp_path.glob("out/*"))


def test_neither_study_nor_maps_is_bad_input(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="give either a contour study"):
        run("--out", tmp_path / "out")


@pytest.mark.slow
def test_it_writes_a_row_and_a_surface_a_level(folder: Path, tmp_path: Path) -> None:
    truth = f"ED_lv_endo={folder / 'truth.stl'}"
    given = [folder / "request.json", "--out", tmp_path, "--reference", truth]
    said = json.loads(run(*given, "--json"))

    written = json.loads((tmp_path / "ablation.json").read_text())
    assert said == {"out": str(tmp_path), **written}
    assert [row["level"] for row in written["rows"]] == [0, 1]
    assert all(row["contour_residual_mean_mm"] > 0.0 for row in written["rows"])
    assert written["rows"][1]["reference"]["hausdorff95_mm"] > 0.0
    assert written["rows"][1]["reference"]["gaussian_curvature_mean_abs_per_mm2"] is None
    assert written["provenance"]["threads"] == 1
    assert written["options"]["levels"] == 2
    surface = pyvista.XMLPolyDataReader(str(tmp_path / "level-1" / "ED_lv_endo.vtp")).read()
    assert len(surface.point_data["distance_mm"]) == surface.n_points

    alone = run(*given[:3], "--levels", "1")
    assert "ED_lv_endo" in alone
    assert "reference" not in alone
    assert "ablation.json and 1 surfaces" in alone
