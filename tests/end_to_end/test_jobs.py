"""A job from submission to files, and everything that may come in between."""

import hashlib
import json
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import pytest

from cli.truth import write_phantom_maps
from schemas.labels import LabelScheme
from tests.end_to_end.following import Job, follow, follow_until_fitting
from tests.end_to_end.serve_process import NEURALMRI, ServeProcess

pytestmark = [pytest.mark.integration, pytest.mark.slow]

Submit = Callable[[ServeProcess, dict[str, Any]], Job]

FAST = {"preset": "fast"}
ENDLESS = {"iterations_per_level": 5000, "levels": 8}


def run(*arguments: str | Path) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [NEURALMRI, *arguments], capture_output=True, text=True, check=False, timeout=300
    )


def meshes(folder: Path) -> dict[str, bytes]:
    return {
        p.name: geometry(p.name, p.read_bytes())
        for p in folder.iterdir()
        if p.suffix in (".stl", ".obj")
    }


def geometry(name: str, content: bytes) -> bytes:
    """A mesh file without what it says of itself, the job's id among it."""
    if name.endswith(".stl"):
        return content[80:]
    if name.endswith(".obj"):
        return b"\n".join(line for line in content.split(b"\n") if not line.startswith(b"#"))
    return content


def test_the_server_and_the_command_line_write_the_same_meshes(
    server: ServeProcess, submit: Submit, study: dict[str, Any], tmp_path: Path
) -> None:
    job = submit(server, FAST)
    assert job["state"] in ("queued", "running")
    done = follow(server, job["id"], "succeeded")
    listed = httpx.get(f"{server.url}{done['links']['artifacts']}").json()["artifacts"]
    served = {}
    for artifact in listed:
        content = httpx.get(f"{server.url}{done['links']['artifacts']}/{artifact['name']}").content
        assert hashlib.sha256(content).hexdigest() == artifact["sha256"]
        served[artifact["name"]] = geometry(artifact["name"], content)
        if artifact["name"].endswith((".stl", ".obj")):
            assert job["id"].encode() in content[:200]
    report = httpx.get(f"{server.url}{done['links']['report']}").json()

    request = tmp_path / "request.json"
    request.write_text(json.dumps({"study": study, "options": FAST}))
    here = tmp_path / "here"
    ended = run("reconstruct", request, "--out", here, "--json")
    assert ended.returncode == 0, ended.stderr

    local = json.loads(ended.stdout)["report"]
    assert sorted(meshes(here)) == sorted(n for n in served if n.endswith((".stl", ".obj")))
    assert meshes(here).items() <= served.items()
    assert local["frames"] == report["frames"]
    assert local["provenance"] == report["provenance"]
    assert sorted(p.name for p in here.iterdir()) == sorted([*served, "manifest.json"])


def test_a_reference_sent_along_is_measured_against(
    server: ServeProcess, study: dict[str, Any], tmp_path: Path
) -> None:
    """A surface made of the same study is its own reference: no distance but that of its file."""
    request = tmp_path / "request.json"
    request.write_text(json.dumps({"study": study, "options": {**FAST, "formats": ["ply"]}}))
    ended = run("reconstruct", request, "--out", tmp_path / "truth")
    assert ended.returncode == 0, ended.stderr
    truth = tmp_path / "truth" / "ED_lv_endo.ply"

    answer = httpx.post(
        f"{server.url}/v1/jobs/contours",
        data={"request": request.read_text()},
        files={"reference_ED_lv_endo": ("any name.bin", truth.read_bytes())},
    )
    assert answer.status_code == 202, answer.text
    done = follow(server, answer.json()["id"], "succeeded")
    report = httpx.get(f"{server.url}{done['links']['report']}").json()
    surfaces = report["frames"][0]["surfaces"]
    assert surfaces["lv_endo"]["reference"]["hausdorff_mm"] < 1e-3
    assert surfaces["lv_epi"]["reference"] is None
    page = httpx.get(f"{server.url}{done['links']['artifacts']}/report.html")
    assert "sandbox allow-scripts" in page.headers["content-security-policy"]


def test_label_maps_go_the_same_two_ways(server: ServeProcess, tmp_path: Path) -> None:
    files = write_phantom_maps(tmp_path, LabelScheme.ACDC)
    options = tmp_path / "options.json"
    options.write_text(json.dumps({**FAST, "formats": ["stl"]}))
    given = ["--label-scheme", "acdc", "--frame-labels", "ED", "--options", options]
    for view, path in files.items():
        given += [f"--{view.value.replace('_', '-')}", path]

    there = run("submit", *given, "--server", server.url, "--wait", "--out", tmp_path / "there")
    here = run("reconstruct", *given, "--out", tmp_path / "here")

    assert (there.returncode, here.returncode) == (0, 0), there.stderr + here.stderr
    assert "ED_lv_endo.stl" in meshes(tmp_path / "here")
    assert meshes(tmp_path / "there") == meshes(tmp_path / "here")


def test_a_running_job_is_cancelled_within_two_seconds(
    server: ServeProcess, submit: Submit
) -> None:
    job = submit(server, ENDLESS)
    follow_until_fitting(server, job["id"])

    asked_s = time.monotonic()
    answer = httpx.post(f"{server.url}{job['links']['cancel']}")
    assert answer.is_success
    follow(server, job["id"], "cancelled", within_s=10)

    assert time.monotonic() - asked_s < 2.0


def test_a_worker_killed_in_the_middle_costs_an_attempt_and_no_result(
    server: ServeProcess, submit: Submit, tmp_path: Path
) -> None:
    job = submit(server, {**FAST, "iterations_per_level": 150, "formats": ["stl"]})
    follow_until_fitting(server, job["id"])
    server.worker_child().kill()

    done = follow(server, job["id"], "succeeded")

    assert done["attempt"] == 2
    folder = server.data_dir / "jobs" / job["id"]
    assert sorted(p.name for p in folder.iterdir()) == [
        "inputs",
        "outcome.json",
        "request.json",
        "results",
    ]


def test_an_erased_job_leaves_nothing(server: ServeProcess, submit: Submit) -> None:
    job = submit(server, ENDLESS)
    follow_until_fitting(server, job["id"])

    assert httpx.delete(f"{server.url}{job['links']['self']}").status_code == 204

    assert httpx.get(f"{server.url}{job['links']['self']}").status_code == 404
    # And the worker is free again.
    next_job = submit(server, FAST)
    follow(server, next_job["id"], "succeeded")
    assert not (server.data_dir / "jobs" / job["id"]).exists()


def test_bad_input_is_refused_in_the_same_words_on_both_ways(
    server: ServeProcess, study: dict[str, Any], tmp_path: Path
) -> None:
    broken = {**study, "units": "parsec"}
    path = tmp_path / "broken.json"
    path.write_text(json.dumps({"study": broken}))

    there = run("submit", path, "--server", server.url, "--json")
    here = run("reconstruct", path, "--out", tmp_path / "out", "--json")

    assert (there.returncode, here.returncode) == (2, 2)
    assert json.loads(here.stdout)["pointer"] == "/study/units"
    assert json.loads(here.stdout)["detail"] == json.loads(there.stdout)["detail"]
