import json

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from cli.beat_arguments import BeatName
from cli.phantom import phantom
from schemas.messages import ContourRequest
from schemas.problem import InputError
from schemas.study import ContourStudy
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import is_outward
from worker.mesh_file import read_surface
from worker.phantom.beating import BeatPreset
from worker.surface_mesh import SurfaceMesh

app = typer.Typer()
app.command()(phantom)

LABELS = [f"F{i:02d}" for i in range(6)]
STRUCTURES = ("lv_endo", "lv_epi", "rv_endo")


def run(*arguments: object) -> str:
    result = CliRunner().invoke(app, [str(a) for a in arguments], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("beat") / "new"
    run("--out", out, "--frames", 6, "--heart-rate", 75, "--edv", 140, "--edge", 3, "--shift-sd", 2)
    return out


@pytest.fixture(scope="module")
def truth(folder):
    return json.loads((folder / "truth.json").read_text())


def test_it_writes_what_it_says(folder):
    surfaces = {f"{label}_{name}.stl" for label in LABELS for name in STRUCTURES}
    others = {"study.json", "request.json", "truth.json", "trajectories.npz"}
    assert {path.name for path in folder.iterdir()} == surfaces | others


def test_the_study_tells_the_time_and_shares_planes_and_displacements(folder, truth):
    study = ContourStudy.model_validate_json((folder / "study.json").read_text())
    request = ContourRequest.model_validate_json((folder / "request.json").read_text())
    assert request.study == study
    assert [frame.label for frame in study.frames] == LABELS
    assert [frame.time_ms for frame in study.frames] == pytest.approx(
        [800 / 6 * i for i in range(6)]
    )
    planes: dict[str, set[object]] = {}
    for frame in study.frames:
        for one in frame.slices:
            planes.setdefault(one.id, set()).add((one.origin, one.normal))
    assert all(len(places) == 1 for places in planes.values())
    assert any(truth["true_shifts_mm"]["sax-03"])


def test_trajectories_are_the_vertices_of_every_frame(folder, truth):
    with np.load(folder / "trajectories.npz") as paths:
        assert paths["labels"].tolist() == LABELS
        assert paths["times_ms"].tolist() == [truth["frames"][x]["time_ms"] for x in LABELS]
        for name in STRUCTURES:
            vertices, faces = paths[f"{name}_vertices_mm"], paths[f"{name}_faces"]
            assert vertices.shape == (6, faces.max() + 1, 3)
            for i, label in enumerate(LABELS):
                carried = SurfaceMesh(vertices[i], faces)
                written = read_surface(folder / f"{label}_{name}.stl")
                told = truth["frames"][label]["surfaces"][name]
                assert is_outward(written)
                assert volume_ml(carried) == pytest.approx(told["volume_ml"])
                assert volume_ml(written) == pytest.approx(told["volume_ml"], rel=1e-5)


def test_the_truth_is_that_of_the_beat(truth):
    function = truth["function"]
    assert function["lv_edv_ml"] == pytest.approx(140.0)
    assert function["lv_ejection_fraction_percent"] == pytest.approx(60.0)
    assert truth["beat"]["cycle"]["duration_ms"] == 800.0
    frames = truth["frames"]
    assert frames["F00"]["twist_deg"] == frames["F00"]["lv_ejected_percent"] == 0.0
    walls = [frame["lv_wall_ml"] for frame in frames.values()]
    assert walls == pytest.approx([walls[0]] * 6)
    for frame in frames.values():
        cavity = frame["surfaces"]["lv_endo"]
        assert cavity["closed_form_volume_ml"] == frame["lv_volume_ml"]
        assert cavity["volume_ml"] == pytest.approx(frame["lv_volume_ml"], rel=1e-2)


def test_presets_have_the_names_of_the_science():
    assert {name.value for name in BeatName} == {preset.value for preset in BeatPreset}


def test_a_given_number_replaces_that_of_the_preset(tmp_path):
    arguments = ("--frames", 2, "--edge", 4, "--beat", "infarct", "--twist", 3, "--json")
    found = json.loads(run("--out", tmp_path, *arguments, "--shape", "wall_mm=10"))
    assert found["beat"]["twist_deg"] == 3.0
    assert found["beat"]["ejection_fraction_percent"] == 40.0
    assert found["beat"]["infarct"]["centre_deg"] == 100.0
    assert found["shape"]["wall_mm"] == 10.0


@pytest.mark.parametrize(
    ("arguments", "remedy"),
    [
        (["--twist", "3"], "add --frames N"),
        (["--beat", "dilated"], "add --frames N"),
        (["--frames", "0"], "frames = 0; choose between 1 and 200"),
        (["--frames", "4", "--heart-rate", "5"], "heart_rate_bpm = 5; choose between"),
        (["--frames", "4", "--edv", "1"], "edv_ml = 1; choose between"),
        (["--frames", "4", "--shape", "radial_shortening=0.2"], "has --ejection-fraction"),
        (
            [
                "--frames",
                "4",
                "--beat",
                "infarct",
                "--ejection-fraction",
                "75",
                "--shortening",
                "30",
            ],
            "smaller infarct",
        ),
    ],
)
def test_bad_input_names_the_remedy(tmp_path, arguments, remedy):
    out = tmp_path / "never"
    with pytest.raises(InputError, match=remedy):
        run("--out", out, "--edge", "4", *arguments)
    assert not out.exists()
