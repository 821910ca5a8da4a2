"""`list`, `cancel`, `erase` and `download` as typed, against a real service."""

import json
import os
import subprocess
import sysconfig
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from schemas.job import JobState
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.redis_server import RedisServer
from tests.service.conftest import Api, serving
from tests.service.jobs_done import FILES, finish
from tests.service.test_jobs import submitted

NEURALMRI = str(Path(sysconfig.get_path("scripts")) / "neuralmri")


@pytest.fixture
def api(redis_server: RedisServer, tmp_path: Path) -> Iterator[Api]:
    settings = ServiceSettings(redis_url=redis_server.url, data_dir=tmp_path / "data")
    with serving(settings) as api:
        for job_id in api.records.ids():
            api.records.forget(job_id)
        yield api


def run(api: Api, *arguments: str | Path) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [NEURALMRI, *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
        env={**os.environ, "NEURALMRI_URL": str(api.client.base_url), "COLUMNS": "60"},
    )


def test_jobs_are_listed_by_state_and_page_by_page(api: Api) -> None:
    ids = [submitted(api) for _ in range(5)]
    finish(api.store, api.records, ids[0], JobState.SUCCEEDED)
    newest = ids[::-1]

    listed = run(api, "list")
    assert listed.returncode == 0, listed.stderr
    assert [line.split()[0] for line in listed.stdout.splitlines()] == newest
    assert listed.stdout.splitlines()[-1].split()[1:4] == ["contours", "succeeded", "100%"]

    two = run(api, "list", "--limit", "2")
    assert [line.split()[0] for line in two.stdout.splitlines()] == newest[:2]
    assert f"--cursor {newest[1]}" in two.stderr
    next_two = json.loads(run(api, "list", "--limit", "2", "--cursor", newest[1], "--json").stdout)
    assert [job["id"] for job in next_two["jobs"]] == newest[2:4]
    assert next_two["next_cursor"] == newest[3]

    everything = json.loads(run(api, "list", "--limit", "2", "--all", "--json").stdout)
    assert [job["id"] for job in everything["jobs"]] == newest
    done = run(api, "list", "--state", "succeeded")
    assert [line.split()[0] for line in done.stdout.splitlines()] == [ids[0]]


def test_a_job_is_cancelled_and_erased(api: Api) -> None:
    job_id = submitted(api)
    cancelled = run(api, "cancel", job_id)
    assert (cancelled.returncode, cancelled.stdout) == (0, "cancelled\n")
    again = run(api, "cancel", job_id, "--json")
    assert json.loads(again.stdout)["state"] == "cancelled"

    erased = run(api, "erase", job_id)
    assert (erased.returncode, erased.stdout) == (0, "erased\n")
    assert json.loads(run(api, "erase", job_id, "--json").stdout) == {"id": job_id, "erased": True}
    gone = run(api, "cancel", job_id, "--json")
    assert gone.returncode == 2
    assert json.loads(gone.stdout)["type"] == "urn:neuralmri:problem:not-found"


def test_files_are_downloaded(api: Api, tmp_path: Path) -> None:
    job_id = submitted(api)
    early = run(api, "download", job_id, "--out", tmp_path / "early")
    assert early.returncode == 2
    assert "not finished" in early.stderr

    finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    whole = run(api, "download", job_id, "--out", tmp_path / "all", "--json")
    assert whole.returncode == 0, whole.stderr
    listed = [artifact["name"] for artifact in json.loads(whole.stdout)["artifacts"]]
    assert sorted(p.name for p in (tmp_path / "all").iterdir()) == sorted(
        [*listed, "manifest.json"]
    )
    for name in listed:
        assert (tmp_path / "all" / name).read_bytes() == FILES[name][0]

    named = ["--name", "report.json", "--name", "ED_lv_endo.stl"]
    some = run(api, "download", job_id, "--out", tmp_path / "some", *named)
    assert sorted(some.stdout.splitlines()) == [
        str(tmp_path / "some" / name) for name in ("ED_lv_endo.stl", "report.json")
    ]


def test_a_part_is_completed_from_the_real_service(api: Api, tmp_path: Path) -> None:
    job_id = submitted(api)
    finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    manifest = api.store.folder(job_id).manifest()
    assert manifest is not None
    (mesh,) = [a for a in manifest.artifacts if a.name == "ED_lv_endo.stl"]
    content = FILES[mesh.name][0]
    (tmp_path / f".{mesh.name}.{mesh.sha256[:16]}.part").write_bytes(content[:1000])
    run(api, "download", job_id, "--out", tmp_path, "--name", mesh.name)
    assert (tmp_path / mesh.name).read_bytes() == content


def test_bash_completes_commands_and_options(tmp_path: Path) -> None:
    """As a user has it: installed into a home of its own, read by a new shell."""
    environment = {
        "PATH": f"{Path(NEURALMRI).parent}{os.pathsep}{os.environ['PATH']}",
        "HOME": str(tmp_path),
    }

    def bash(program: str) -> str:
        return subprocess.run(
            ["bash", "-c", program],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
            timeout=60,
        ).stdout

    bash("neuralmri --install-completion bash")
    assert ".bash_completions/neuralmri.sh" in (tmp_path / ".bashrc").read_text()
    completed = bash(
        "source ~/.bash_completions/neuralmri.sh\n"
        "complete -p neuralmri\n"
        "COMP_WORDS=(neuralmri ca) COMP_CWORD=1\n"
        "_neuralmri_completion neuralmri; echo ${COMPREPLY[@]}\n"
        "COMP_WORDS=(neuralmri list --st) COMP_CWORD=2\n"
        "_neuralmri_completion neuralmri; echo ${COMPREPLY[@]}\n"
        "COMP_WORDS=(neuralmri webhooks re) COMP_CWORD=2\n"
        "_neuralmri_completion neuralmri; echo ${COMPREPLY[@]}"
    ).splitlines()
    assert "neuralmri" in completed[0]
    assert completed[1:] == ["cancel", "--state", "remove replay"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish", "powershell"])
def test_the_completion_of_each_shell_can_be_shown(shell: str) -> None:
    """For those who keep their shell's files themselves: nothing is written."""
    shown = subprocess.run(
        [NEURALMRI, "--show-completion", shell],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    ).stdout
    assert "_NEURALMRI_COMPLETE" in shown


def test_submit_follows_by_events(api: Api, tmp_path: Path) -> None:
    """The job is not asked for again and again."""
    study = tmp_path / "request.json"
    study.write_text(json.dumps(CONTOUR_REQUEST))
    with ThreadPoolExecutor(1) as one:
        sent = one.submit(run, api, "submit", study, "--wait", "--json")
        while not (ids := api.records.ids()):
            time.sleep(0.05)
        time.sleep(2.0)
        finish(api.store, api.records, ids[0], JobState.SUCCEEDED)
        done = sent.result(timeout=60.0)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["state"] == "succeeded"
    counted = [
        line
        for line in api.client.get("/metrics").text.splitlines()
        if line.startswith("neuralmri_http_requests_total") and "/v1/jobs/{job_id}" in line
    ]
    assert len(counted) == 1, counted
    assert 'route="/v1/jobs/{job_id}/events",status="200"} 1.0' in counted[0]


def test_submit_says_how_the_job_is_to_be_treated(api: Api, tmp_path: Path) -> None:
    study = tmp_path / "request.json"
    study.write_text(json.dumps(CONTOUR_REQUEST))
    terms = ("--priority", "batch", "--retain", "3600")
    sent = run(api, "submit", study, "--json", *terms)
    assert sent.returncode == 0, sent.stderr
    job = json.loads(sent.stdout)
    assert job["priority"] == "batch"
    assert api.store.folder(job["id"]).request().retain_s == 3600.0
    # Nothing has been done yet, so there is nothing to be had again.
    again = json.loads(run(api, "submit", study, "--json", "--reuse").stdout)
    assert again["id"] != job["id"]
