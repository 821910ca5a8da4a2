"""The command as a user types it: what it says, and with which exit code it ends."""

import json
import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from tests.redis_server import free_port

NEURALMRI = str(Path(sysconfig.get_path("scripts")) / "neuralmri")

STUDY = {
    "subject_id": "case-01",
    "units": "mm",
    "axes": "LPS",
    "frames": [
        {
            "label": "ED",
            "slices": [
                {
                    "id": "sax-00",
                    "contours": [
                        {
                            "structure": "lv_endo",
                            "points": [[0, 0, 0], [30, 0, 0], [30, 30, 0], [0, 30, 0]],
                        }
                    ],
                }
            ],
        }
    ],
}


def run(*arguments: str | Path) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [NEURALMRI, *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        env={**os.environ, "COLUMNS": "200", "TERM": "dumb"},
    )


def test_help_names_every_subcommand_and_loads_no_science() -> None:
    ended = run("--help")
    assert ended.returncode == 0
    commands = "serve", "reconstruct", "submit", "evaluate", "ablate", "slice", "phantom", "demo"
    for name in (*commands, "keys", "list", "cancel", "erase", "download", "watch"):
        assert name in ended.stdout
    code = "import cli.main, sys; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert not {"torch", "numpy", "scipy", "celery", "fastapi"} & set(loaded)


def test_bad_input_ends_with_2_and_says_where_and_what_to_do(tmp_path: Path) -> None:
    study = tmp_path / "study.json"
    study.write_text(json.dumps(STUDY))
    ended = run("reconstruct", study, "--out", tmp_path / "out")
    assert ended.returncode == 2
    assert "Error:" in ended.stderr
    assert "/frames/0" in ended.stderr
    assert "/study" not in ended.stderr, "the file is the study; it has no key of that name"
    assert "Traceback" not in ended.stderr
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.parametrize("command", ["reconstruct", "submit"])
def test_a_reference_without_a_name_says_how_to_name_it(command: str, tmp_path: Path) -> None:
    study, truth = tmp_path / "study.json", tmp_path / "truth.ply"
    study.write_text(json.dumps(STUDY))
    truth.touch()
    out = ["--out", tmp_path / "out"] if command == "reconstruct" else []
    ended = run(command, study, *out, "--reference", truth)
    assert ended.returncode == 2
    assert f"--reference ED_lv_endo={truth}" in ended.stderr


def test_bad_input_for_a_machine_is_a_problem_document_on_standard_output(tmp_path: Path) -> None:
    request = tmp_path / "request.json"
    request.write_text(json.dumps({"study": STUDY, "options": {"levels": 99}}))
    ended = run("reconstruct", request, "--out", tmp_path / "out", "--json")
    problem = json.loads(ended.stdout)
    assert ended.returncode == 2
    assert problem["fault"] == "caller"
    assert problem["pointer"] == "/options/levels"


def test_a_server_that_is_not_there_is_our_fault_and_says_what_to_do(tmp_path: Path) -> None:
    study = tmp_path / "study.json"
    study.write_text(json.dumps(STUDY))
    nowhere = f"http://127.0.0.1:{free_port()}"
    ended = run("submit", study, "--server", nowhere, "--retry-within", "1")
    assert ended.returncode == 1
    assert "trying again" in ended.stderr
    assert "neuralmri serve" in ended.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["reconstruct", "no-such-file.json", "--out", "out"],
        ["reconstruct", "--out", "out"],
        ["ablate", "--out", "out"],
        ["submit", "--sax", __file__],
        ["submit", __file__, "--reference", "no-such-file.ply"],
        ["serve", "--port", "0"],
        ["no-such-command"],
        ["list", "--limit", "0"],
        ["list", "--state", "done"],
        ["list", "--server", "127.0.0.1:8000"],
        ["cancel", "../jobs"],
        ["erase", ""],
        ["download", "1" * 32],
    ],
)
def test_wrong_use_ends_with_2(arguments: list[str], tmp_path: Path) -> None:
    ended = run(*arguments)
    assert ended.returncode == 2
    assert "Traceback" not in ended.stderr


def test_an_outside_redis_that_does_not_answer_stops_the_server_with_its_reason(
    tmp_path: Path,
) -> None:
    ended = subprocess.run(
        [
            *(NEURALMRI, "serve", "--port", str(free_port()), "--data-dir", tmp_path / "data"),
            *("--redis-url", f"redis://127.0.0.1:{free_port()}/0", "--ready-within", "10"),
        ],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert ended.returncode == 1
    assert "Redis does not answer" in ended.stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["reconstruct", "study.json", "--out", "study.json/out"], "Not a directory"),
        (["serve", "--data-dir", "study.json/data", "--port", str(free_port())], "Not a directory"),
        (["submit", "study.json", "--server", "http://127.0.0.1:port"], "no address"),
        (["serve", "--host", "192.0.2.1", "--port", str(free_port())], "--allow-remote"),
        (["serve", "--host", "::", "--port", str(free_port())], "--allow-remote"),
    ],
)
def test_a_place_that_cannot_be_used_is_named_without_a_traceback(
    arguments: list[str], said: str, tmp_path: Path
) -> None:
    (tmp_path / "study.json").write_text(json.dumps(STUDY))
    ended = subprocess.run(
        [NEURALMRI, *arguments],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert ended.returncode == 2
    assert said in ended.stderr
    assert "Traceback" not in ended.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["study.json"]
