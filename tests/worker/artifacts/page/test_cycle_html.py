"""What the page says of a whole cycle."""

import re
from dataclasses import replace

import pytest
from plotly.offline import get_plotlyjs

from schemas.job import Progress
from tests.worker.artifacts.page.example_report import report as example_report
from tests.worker.artifacts.page.measured_cycle import measured_cycle
from tests.worker.artifacts.page.measured_phantom import measured_phantom
from tests.worker.artifacts.page.test_html import _Balanced, figures_of
from worker.artifacts.display_meshes import display_meshes
from worker.artifacts.measured import Measured
from worker.artifacts.page.html import render_html
from worker.observer import Unobserved
from worker.tracking.tracked_surface import NOT_OBSERVED


def page_of(measured: Measured) -> str:
    return render_html(measured).replace(get_plotlyjs(), "")


@pytest.fixture(scope="module")
def page() -> str:
    return page_of(measured_cycle())


def test_it_is_well_formed(page: str) -> None:
    for one in (page, page_of(measured_cycle(3, times=False, cycle=False))):
        parser = _Balanced()
        parser.feed(one)
        assert parser.open == []
        assert len(parser.ids) == len(set(parser.ids))


def test_it_tells_which_frame_it_draws() -> None:
    told: list[str | None] = []

    class Watching(Unobserved):
        def advanced(self, progress: Progress) -> None:
            told.append(progress.frame)

    measured = measured_cycle()
    render_html(measured, Watching(), thinned=display_meshes(measured))
    assert told == ["F00", "F01", "F02", "F03"]


@pytest.mark.parametrize(
    "fact",
    [
        "4 frames, 0.16 s",
        "<td>101.2</td>",
        "<td>41.8</td>",
        "<strong>58.7</strong>",
        "<td>457</td><td>346</td><td>0.43</td>",
        '<td class="text">F00</td><td class="text">F03</td>',
        "Shown as one mesh carried through the frames: lv_endo.",
        "Of lv_epi, rv_endo each frame has a mesh of its own.",
    ],
)
def test_it_tells_of_the_cycle(page: str, fact: str) -> None:
    assert fact in page


def with_function(**change: str | float | None) -> str:
    measured = measured_cycle()
    function = example_report().function
    assert function is not None
    of_cycle = {"ed_frame": "F00", "es_frame": "F03", "rv_edv_ml": None}
    function = function.model_copy(update=of_cycle | change)
    return page_of(
        replace(measured, report=measured.report.model_copy(update={"function": function}))
    )


def test_what_the_cycle_tells_of_function_is_not_told_twice() -> None:
    page = with_function(lv_fractional_area_change_percent=51.25)
    assert "<h2>Function</h2>" not in page
    assert "half-way from apex to base is 51.2 % smaller at ES." in page


RIGHT = {
    "rv_edv_ml": 98.75,
    "rv_esv_ml": 49.5,
    "rv_stroke_volume_ml": 49.25,
    "rv_ejection_fraction_percent": 49.9,
}


@pytest.mark.parametrize("change", [{"es_frame": "F02"}, RIGHT])
def test_function_that_the_cycle_does_not_tell_stays(change: dict[str, str | float]) -> None:
    page = with_function(lv_fractional_area_change_percent=51.25, **change)
    assert page.count("<h2>Function</h2>") == 1
    assert "smaller at ES" not in page


def test_what_is_not_observed_is_said_at_the_tracked_mesh_and_at_its_strain(page: str) -> None:
    assert page.count(NOT_OBSERVED) == 2


def test_frames_are_folded_and_can_be_gone_to(page: str) -> None:
    folded = re.findall(r'<details class="frame" id="(\w+)">\n<summary><h2>Frame (\w+)', page)
    assert folded == [(f"frame{n}", f"F0{n}") for n in range(4)]
    assert [page.count(f'href="#frame{n}"') for n in range(4)] == [1] * 4
    assert '<section class="frame">' not in page


def test_every_figure_of_the_cycle_has_its_place(page: str) -> None:
    figures = figures_of(page)
    charts = [name for name in figures["charts"] if name.startswith("cycle-")]
    assert charts == [f"cycle-chart{n}" for n in range(12)]
    for name in charts:
        assert page.count(f'id="{name}"') == 1
    assert [one["structure"] for one in figures["cycle"]["surfaces"]] == [
        "lv_endo",
        "lv_epi",
        "rv_endo",
    ]
    assert page.count("data-surface=") == 3


def test_without_times_and_measures_there_is_still_something_to_play() -> None:
    page = page_of(measured_cycle(3, times=False, cycle=False))
    assert "times are not known: 1 s for the whole" in page
    assert 'id="player-play"' in page
    assert "ejection<br>rate" not in page
    assert "cycle-chart" not in figures_of(page)["charts"]


def test_peak_rates_that_are_not_known_are_dashes() -> None:
    page = page_of(measured_cycle(3, times=False))
    assert "<td>\N{EN DASH}</td><td>\N{EN DASH}</td><td>0.43</td>" in page
    assert "there are none without times" in page


def test_two_frames_are_shown_as_they_are() -> None:
    page = page_of(measured_phantom(("ED", "ES"), edge_mm=5.0))
    assert 'class="cycle"' not in page
    assert page.count('<section class="frame">') == 2
    assert "cyclePlayer = " not in page
    assert figures_of(page)["cycle"] is None
