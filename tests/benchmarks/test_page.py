"""The page from a small results file: tables of one width, numbers where they belong."""

import re
from pathlib import Path

from benchmarks.methods import RIVALS
from benchmarks.page import page
from benchmarks.plots.files import draw
from benchmarks.results import Results
from benchmarks.tables import comparison, cost, overview
from benchmarks.tables.case_by_case import case_by_case
from benchmarks.tables.markdown import lowest_bold, number


def rows_of(table: str) -> list[list[str]]:
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in table.splitlines()]


def row(table: str, first: str) -> dict[str, str]:
    header, _, *rows = rows_of(table)
    (found,) = (r for r in rows if r[0] == first)
    return dict(zip(header, found, strict=True))


def test_results_survive_their_file(results: Results) -> None:
    text = results.model_dump_json(exclude_none=True)
    assert Results.model_validate_json(text) == results


def test_glance_has_the_geometric_means_and_counts_failures(results: Results) -> None:
    table = overview.glance(results)
    assert row(table, "field, standard")["phantom in place: mean"] == "0.06"
    assert row(table, "field, unaligned")["phantom in place: mean"] == "**0.05**"
    assert row(table, "Hermite RBF")["displaced: mean"] == "1.60"
    assert row(table, "lofting")["failed"] == "1/2"
    assert row(table, "lofting")["phantom in place: mean"] == "-"


def test_failures_say_why(results: Results) -> None:
    assert rows_of(overview.failures(results))[2:] == [
        ["phantom 8 mm 3 LAX", "lofting", "lv_endo", "no surface"]
    ]


def test_ratios_and_their_summary(results: Results) -> None:
    published, refined = RIVALS
    assert row(comparison.against(results, published), "heart-shifted")["lv_endo"] == (
        "0.12 / 0.12 / 0.12"
    )
    assert row(comparison.against(results, refined), "heart-shifted")["lv_endo"] == (
        "0.25 / 0.25 / 0.25"
    )
    every = row(comparison.against_in_short(results, published), "all")
    assert (every["surfaces"], every["closer in"]) == ("2", "2")
    assert every["mean"] == "**0.25**"
    assert every["worst mean"] == "0.50"
    assert row(comparison.against_in_short(results, refined), "all")["worst mean"] == "0.75"


def test_each_rival_has_a_block_of_its_own(results: Results) -> None:
    blocks = page(results, {}).split("\n### ")[1:]
    first, second = (block for block in blocks if block.startswith('"field, standard" against'))
    assert first.startswith('"field, standard" against "Hermite RBF"\n')
    assert second.startswith('"field, standard" against "Hermite RBF, refined"\n')
    assert "0.12 / 0.12 / 0.12" in first
    assert "0.25 / 0.25 / 0.25" in second


def test_alignment_costs_and_gains(results: Results) -> None:
    table = comparison.alignment(results)
    assert row(table, "phantom 8 mm 3 LAX")["lv_endo"] == "+20.0"
    assert row(table, "heart-shifted")["lv_endo"] == "-80.0"
    left = row(comparison.shifts(results), "heart-shifted")
    assert left == {"case": "heart-shifted", "before": "4.00", "after: field, standard": "0.40"}


def test_speed_takes_medians(results: Results) -> None:
    table = cost.speed(results)
    assert row(table, "**fit / products**")["median"] == "**4.00**"
    assert row(table, "subjects a minute, 1 process")["median"] == "6.00"
    assert row(table, "share of 2 times one process")["median"] == "92 %"
    assert row(cost.costs(results), "lofting")["of it the method"] == "200"


def test_case_by_case_shows_every_record(results: Results) -> None:
    text = case_by_case(results)
    assert "0.20 / 0.30 / 0.60 / 2.0 / -0.2" in text
    assert text.count("failed") == 4  # the whole, and three regions


def test_regions_are_of_cases_in_place(results: Results) -> None:
    assert row(overview.regions(results), "Hermite RBF")["apex: mean"] == "0.24"


def test_page_is_whole(results: Results, tmp_path: Path) -> None:
    plots = draw(results, tmp_path)
    assert set(plots) == {"error", "time", *(f"ratio-{rival}" for rival in RIVALS)}
    text = page(results, {name: f"benchmarks/{file.name}" for name, file in plots.items()})
    assert not re.search(r"\{\w*\}", text)
    for block in re.findall(r"(?:^\|.*\|\n?)+", text, re.MULTILINE):
        assert len({line.count("|") for line in block.splitlines()}) == 1
    for file in plots.values():
        assert f"](benchmarks/{file.name})" in text
        assert file.stat().st_size < 500_000


def test_the_same_results_draw_the_same_files(results: Results, tmp_path: Path) -> None:
    twice = [tmp_path / "one", tmp_path / "other"]
    for folder in twice:
        folder.mkdir()
    first, second = (draw(results, folder) for folder in twice)
    for name, file in first.items():
        assert file.read_bytes() == second[name].read_bytes()


def test_a_part_of_a_run_makes_a_page(results: Results) -> None:
    bare = results.model_copy(update={"speed": None, "records": results.records[:1]})
    assert "Not measured in this run." in page(bare, {})


def test_numbers() -> None:
    assert number(None, 1) == number(float("nan"), 1) == "-"
    assert number(0.5, 1, sign=True) == "+0.5"
    assert lowest_bold([0.101, 0.2, 0.104, float("nan")], 2) == [
        "**0.10**",
        "0.20",
        "**0.10**",
        "-",
    ]
