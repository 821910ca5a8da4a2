"""The page from a small results file: numbers where they belong, parts that were not measured."""

import subprocess
import sys
from pathlib import Path

from benchmarks.beating.page import page
from benchmarks.beating.plots import draw
from benchmarks.beating.results import BeatingResults
from benchmarks.beating.tables import killed, phantom, real, sliced
from benchmarks.measure import ROOT


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "benchmarks.beating", *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_results_survive_their_file(results: BeatingResults) -> None:
    assert BeatingResults.model_validate_json(results.model_dump_json()) == results


def test_a_real_cycle_tells_first_frames_from_others(results: BeatingResults) -> None:
    assert results.patient1 is not None
    text = real.costs(results.patient1)
    assert "| fit of the first frame, CPU s | 9.0 | - |" in text
    assert "| fit of another, CPU s | 2.50 | - |" in text
    assert "| measuring, wall s | 20.0 | 15.0 |" in text
    assert "total" not in text
    text = real.pumping(results.patient1)
    assert "| lv_endo, from neighbours (default) | 100.0 | 40.0 | 60.0 | 100.0 | - |" in text
    assert "| lv_endo | 0.60 | 0.70 | 1.50 | 2.00 |" in real.residuals(results.patient1)


def test_errors_of_a_sliced_cycle_are_found_less_true(results: BeatingResults) -> None:
    assert results.sliced is not None
    text = sliced.errors(results.sliced)
    assert "| lv_endo, from neighbours | 0.200 | 0.300 | +1.00 | 0.00 | -0.50 |" in text
    assert "| lv_endo, each from nothing | 0.400 | 0.600 | -3.33 | 5.77 | +10.00 |" in text
    text = sliced.tracked(results.sliced)
    assert "| lv_endo | 0.100 | 0.200 | 0.300 | 0 | 0 | 2 | 21.0° | 0.25 / 1.5 |" in text


def test_a_phantom_is_shown_where_its_surface_is_smallest(results: BeatingResults) -> None:
    assert results.phantom is not None
    text = phantom.paths(results.phantom)
    assert "| 0.10 / 0.05 | 2.00 / 1.00 | 4.0 | -40.0 | -39.0 | 5.0 |" in text
    assert "| 1.67 | 5.00 | -2.00 | 0 | 0 | 2 |" in phantom.volumes(results.phantom)


def test_what_is_not_the_same_is_named(results: BeatingResults) -> None:
    assert results.killed is not None
    assert "not the same" not in killed.killed(results.killed)
    spoilt = results.killed.model_copy(update={"not_the_same": ["a.stl"]})
    assert "| not the same | a.stl |" in killed.killed(spoilt)


def test_a_part_that_was_not_measured_says_so(results: BeatingResults) -> None:
    only = BeatingResults(killed=results.killed)
    text = page(only, {})
    assert text.count("Not measured yet.") == 7
    assert "| attempts | 2 |" in text


def test_a_short_run_is_called_one(results: BeatingResults) -> None:
    text = page(results, {})
    assert "A short run: 3 of 25 frames" in text
    assert "A short run: 3 of 20 frames" in text
    assert "\n\n\n" not in text


def test_page_and_plots_are_made_anew_from_results(results: BeatingResults, tmp_path: Path) -> None:
    (tmp_path / "beating.json").write_text(results.model_dump_json())
    ended = run("--render", "--out", str(tmp_path))
    assert ended.returncode == 0, ended.stderr
    text = (tmp_path / "beating.md").read_text()
    assert "A processor" in text
    assert "Not measured" not in text
    for plot in ("beating-volumes.svg", "beating-distances.svg"):
        assert plot in text
        assert (tmp_path / plot).is_file()


def test_plots_are_the_same_files_for_the_same_numbers(
    results: BeatingResults, tmp_path: Path
) -> None:
    drawn = []
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        files = draw(results, tmp_path / name)
        drawn.append({plot: file.read_bytes() for plot, file in files.items()})
    assert drawn[0] == drawn[1]


def test_an_unknown_part_is_refused_and_one_without_data_left_out(tmp_path: Path) -> None:
    assert run("--only", "guessing").returncode == 2
    ended = run("--only", "sliced", "--out", str(tmp_path))
    assert ended.returncode == 0
    assert "sliced: left out, name its data with --data" in ended.stderr
