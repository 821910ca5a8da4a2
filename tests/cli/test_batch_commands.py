"""`submit-batch`, and the commands that take a batch's id, as typed, against a real service."""

import json
from pathlib import Path
from typing import Any

import pytest

from cli.batch_files import read_batch_files
from schemas.job import JobState
from schemas.problem import InputError
from service.examples import CONTOUR_REQUEST
from tests.cli.test_server_commands import api, run
from tests.service.conftest import Api
from tests.service.jobs_done import FILES, finish

__all__ = ["api"]

STUDY = CONTOUR_REQUEST["study"]


@pytest.fixture
def cohort(tmp_path: Path) -> Path:
    folder = tmp_path / "cohort"
    folder.mkdir()
    (folder / "a.json").write_text(json.dumps(STUDY))
    (folder / "b.json").write_text(json.dumps(CONTOUR_REQUEST))
    (folder / "notes.txt").write_text("no study")
    return folder


def test_a_folder_is_one_batch_until_it_is_erased(api: Api, cohort: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.json"
    bad.write_text("{}")
    sent = run(api, "submit-batch", cohort, bad)
    assert sent.returncode == 2, sent.stderr
    assert "refused: bad: " in sent.stderr
    batch_id = sent.stdout.strip()
    here = f"/v1/batches/{batch_id}"
    found = api.client.get(here).json()
    assert [(m["name"], m["state"]) for m in found["studies"]] == [
        ("a", "queued"),
        ("b", "queued"),
        ("bad", "refused"),
    ]
    first = found["studies"][0]["job_id"]
    finish(api.store, api.records, first, JobState.SUCCEEDED)

    cancelled = run(api, "cancel", batch_id)
    assert cancelled.stdout == "1 refused, 1 cancelled, 1 succeeded\n"
    watched = run(api, "watch", batch_id)
    assert watched.returncode == 2
    assert [line.split()[1:3] for line in watched.stdout.splitlines()] == [
        ["succeeded", "a"],
        ["cancelled", "b"],
        ["refused", "bad"],
    ]
    out = tmp_path / "out"
    fetched = run(api, "download", batch_id, "--out", out)
    assert fetched.stdout == f"{out / 'a'}\n"
    assert (out / "a" / "ED_lv_endo.stl").read_bytes() == FILES["ED_lv_endo.stl"][0]
    assert [path.name for path in out.iterdir()] == ["a"]
    assert run(api, "erase", batch_id).stdout == "erased\n"
    assert api.client.get(here).status_code == 404
    assert api.store.ids() == []


def test_json_for_machines(api: Api, cohort: Path, tmp_path: Path) -> None:
    options = tmp_path / "options.json"
    options.write_text('{"seed": 7}')
    sent = run(api, "submit-batch", cohort / "a.json", "--options", options, "--json")
    assert sent.returncode == 0, sent.stderr
    batch: dict[str, Any] = json.loads(sent.stdout)
    (member,) = batch["studies"]
    contours = api.store.folder(member["job_id"]).request().contours
    assert contours is not None
    assert contours.options.seed == 7
    finish(api.store, api.records, member["job_id"], JobState.SUCCEEDED)
    watched = run(api, "watch", batch["id"], "--json")
    assert (watched.returncode, json.loads(watched.stdout)["ended"]) == (0, True)
    fetched = run(api, "download", batch["id"], "--out", tmp_path / "out", "--json")
    assert json.loads(fetched.stdout) == {
        "folders": {member["job_id"]: str(tmp_path / "out" / "a")}
    }
    run(api, "erase", batch["id"])


def test_where_none_is_accepted(api: Api, tmp_path: Path) -> None:
    bad = tmp_path / "bad.json"
    bad.write_text("{}")
    sent = run(api, "submit-batch", bad)
    assert sent.returncode == 2
    assert "none of the 1 studies was accepted" in sent.stderr


def test_what_cannot_be_sent_is_told_before(tmp_path: Path) -> None:
    for text in ("{", "[]", ""):
        path = tmp_path / "study.json"
        path.write_text(text)
        with pytest.raises(InputError, match=r"study\.json"):
            read_batch_files([path], None)
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(InputError, match=r"no \*\.json"):
        read_batch_files([empty], None)


def test_a_study_is_called_as_its_file(tmp_path: Path) -> None:
    for name in ("case 1.json", "case-2.json"):
        (tmp_path / name).write_text("{}")
    named = tmp_path / "x.json"
    named.write_text('{"study": {}, "name": "own"}')
    body = read_batch_files([tmp_path], None)
    assert [entry.get("name") for entry in body["studies"]] == [None, "case-2", "own"]
