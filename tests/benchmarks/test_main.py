"""The command line: a page from a results file, and a real run of one cheap method."""

import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.measure import ROOT
from benchmarks.results import Results


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "benchmarks", *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_page_and_plots_are_made_anew_from_results(results: Results, tmp_path: Path) -> None:
    folder = tmp_path / "benchmarks"
    folder.mkdir()
    (folder / "results.json").write_text(results.model_dump_json())
    ended = run("--render", "--out", str(tmp_path))
    assert ended.returncode == 0, ended.stderr
    assert "A processor" in (tmp_path / "benchmarks.md").read_text()
    assert {file.name for file in folder.glob("*.svg")} == {
        "error.svg",
        "ratio-hermite-rbf.svg",
        "ratio-hermite-rbf-refined.svg",
        "time.svg",
    }


def test_an_unknown_method_is_refused() -> None:
    ended = run("--methods", "guessing")
    assert ended.returncode == 2
    assert "hermite-rbf" in ended.stderr


@pytest.mark.slow
def test_a_run_of_one_method_on_one_phantom(tmp_path: Path) -> None:
    ended = run("--only", "12 mm", "--methods", "shape-linear", "--out", str(tmp_path))
    assert ended.returncode == 0, ended.stderr
    results = Results.model_validate_json((tmp_path / "benchmarks" / "results.json").read_bytes())
    assert [case.name for case in results.cases] == ["phantom 12 mm 3 LAX"]
    for record in results.records:
        assert record.failure is None
        assert record.whole is not None
        assert record.whole.mean_mm < 1.0
