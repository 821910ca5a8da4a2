"""`neuralmri rerun`: what was done is done again, and is the same."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cli.truth import write_phantom_maps
from schemas.labels import LabelScheme
from tests.end_to_end.following import Job, follow
from tests.end_to_end.serve_process import ServeProcess
from tests.end_to_end.test_jobs import FAST, run

pytestmark = [pytest.mark.integration, pytest.mark.slow]

QUICK = {"preset": "fast", "seed": 7, "formats": ["stl", "obj", "ply", "vtp", "glb"]}


def verdicts(printed: str) -> dict[str, str]:
    document: dict[str, Any] = json.loads(printed)
    return {artifact["name"]: artifact["verdict"] for artifact in document["artifacts"]}


def test_a_job_of_a_server_is_done_again_from_its_address_alone(
    server: ServeProcess,
    submit: Callable[[ServeProcess, dict[str, Any]], Job],
) -> None:
    job = submit(server, QUICK)
    follow(server, job["id"], "succeeded")

    ended = run("rerun", f"{server.url}/v1/jobs/{job['id']}", "--json")

    assert ended.returncode == 0, ended.stdout + ended.stderr
    found = verdicts(ended.stdout)
    assert {"ED_lv_endo.stl", "ED_lv_endo.vtp", "report.json", "report.html"} <= set(found)
    assert set(found.values()) == {"same"}, "byte for byte, the job's id in the meshes too"
    assert json.loads(ended.stdout)["versions"] == []


def test_a_folder_is_done_again_from_its_input_and_nothing_else(
    study_file: Path, tmp_path: Path
) -> None:
    options = tmp_path / "options.json"
    options.write_text(json.dumps({**FAST, "seed": 7}))
    then = tmp_path / "then"
    made = run("reconstruct", study_file, "--options", options, "--out", then)
    assert made.returncode == 0, made.stderr

    ended = run("rerun", then, study_file)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert "same: ED_lv_endo.stl\n" in ended.stdout
    assert ended.stdout.endswith("the same\n")

    # One vertex of one mesh, one number of the report and one version are not what they were.
    changed = bytearray((then / "ED_lv_endo.stl").read_bytes())
    changed[100] ^= 1
    (then / "ED_lv_endo.stl").write_bytes(changed)
    report = json.loads((then / "report.json").read_text())
    report["frames"][0]["surfaces"]["lv_endo"]["volume_ml"] += 1.0
    report["provenance"]["libraries"]["torch"] = "1.0"
    (then / "report.json").write_text(json.dumps(report))
    (then / "ED_lv_epi.obj").unlink()

    ended = run("rerun", then, study_file)
    assert ended.returncode == 1, ended.stderr
    for line in (
        "different: ED_lv_endo.stl\n",
        "different: report.json\n",
        "new: ED_lv_epi.obj\n",
        "same: ED_lv_endo.obj\n",
        "version: torch was 1.0, is ",
        "install the versions of then",
    ):
        assert line in ended.stdout

    other = json.loads(study_file.read_text())
    other["frames"][0]["slices"][0]["contours"][0]["points"][0][0] += 0.1
    study_file.write_text(json.dumps(other))
    ended = run("rerun", then, study_file)
    assert ended.returncode == 2
    assert "made from something else" in ended.stderr


def test_label_maps_are_named_again(server: ServeProcess, tmp_path: Path) -> None:
    files = write_phantom_maps(tmp_path, LabelScheme.ACDC)
    options = tmp_path / "options.json"
    options.write_text(json.dumps({**FAST, "formats": ["stl"]}))
    maps = ["--label-scheme", "acdc", "--frame-labels", "ED"]
    for view, path in files.items():
        maps += [f"--{view.value.replace('_', '-')}", str(path)]
    sent = ["--subject-id", "case-01", "--options", options, "--server", server.url]
    made = run("submit", *maps, *sent, "--wait", "--out", tmp_path / "then", "--json")
    assert made.returncode == 0, made.stderr
    address = f"{server.url}/v1/jobs/{json.loads(made.stdout)['id']}"

    refused = run("rerun", address)
    assert refused.returncode == 2
    assert "label maps" in refused.stderr

    for job in (address, str(tmp_path / "then")):
        ended = run("rerun", job, *maps, "--json")
        assert ended.returncode == 0, ended.stdout + ended.stderr
        assert set(verdicts(ended.stdout).values()) == {"same"}
    shutil.rmtree(tmp_path / "then")
    assert run("rerun", tmp_path / "then", *maps).returncode == 2
