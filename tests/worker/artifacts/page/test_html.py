"""The page as text: what it says, and that nothing of it is fetched or believed."""

import json
import re
from html.parser import HTMLParser
from typing import Any

import pytest
from plotly.offline import get_plotlyjs

from schemas.options import Options
from schemas.report import Report
from schemas.vocabulary import Structure
from tests.worker.artifacts.page.example_report import (
    EVEN,
    UNEVEN,
    distances,
    frame_report,
    left_ventricle_report,
    reference_report,
    report,
    slice_report,
    surface_report,
)
from tests.worker.artifacts.page.measured_phantom import measured_phantom
from worker.artifacts.measured import Measured, MeasuredFrame
from worker.artifacts.page.html import render_html


def page_of(whole: Report) -> str:
    """The page of a report, of which nothing is drawn."""
    frames = [MeasuredFrame(label=one.label, surfaces={}, slices=[]) for one in whole.frames]
    return render_html(Measured(whole, frames)).replace(get_plotlyjs(), "")


@pytest.fixture(scope="module")
def drawn() -> str:
    """A page with everything on it, but plotly.js."""
    page = render_html(measured_phantom(("ED", "ES"), edge_mm=5.0))
    assert page.count(get_plotlyjs()) == 1
    return page.replace(get_plotlyjs(), "")


class _Balanced(HTMLParser):
    """Fails on a closing tag that does not match the last one opened."""

    void = frozenset({"meta", "br", "img", "input", "path"})

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.ids += [value or "" for name, value in attrs if name == "id"]
        if tag not in self.void:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in self.void:
            assert self.open.pop() == tag


def figures_of(page: str) -> dict[str, Any]:
    (text,) = re.findall(r'<script type="application/json" id="figures">(.*?)</script>', page)
    return dict(json.loads(text))


def test_the_page_is_well_formed(drawn: str) -> None:
    for page in (drawn, page_of(report())):
        parser = _Balanced()
        parser.feed(page)
        assert parser.open == []
        assert len(parser.ids) == len(set(parser.ids))


def test_the_page_fetches_nothing(drawn: str) -> None:
    assert not re.search(r"https?:|//cdn|@import|url\(", drawn)
    addresses = re.findall(r"""(?:src|href|action|data)=["']?([^"'>\s]+)""", drawn)
    assert set(addresses) == {"#frame0", "#frame1"} | {
        f"{frame}_{structure}.{form}"
        for frame in ("ED", "ES")
        for structure in ("lv_endo", "lv_epi", "rv_endo")
        for form in ("stl", "vtp")
    }


def test_the_same_input_makes_the_same_page() -> None:
    first, second = (render_html(measured_phantom(edge_mm=5.0)) for _ in range(2))
    assert first == second


def test_every_figure_has_its_place_and_every_slice_its_panel(drawn: str) -> None:
    figures = figures_of(drawn)
    assert list(figures["scenes"]) == ["frame0-scene", "frame1-scene"]
    for name in [*figures["scenes"], *figures["charts"]]:
        assert drawn.count(f'id="{name}"') == 1
    slices = sum(len(one.slices) for one in measured_phantom(("ED", "ES"), edge_mm=5.0).frames)
    assert drawn.count('<figure class="panel">') == slices


def test_text_of_the_caller_is_escaped() -> None:
    hostile = "`</script><script>alert('x')</script>`<!--"
    surface = surface_report(files=[f"{hostile}.stl"])
    ventricle = left_ventricle_report().model_copy(update={"not_measured": {hostile: hostile}})
    frame = frame_report(
        "ED",
        surfaces={Structure.LV_ENDO: surface},
        left_ventricle=ventricle,
        slices=[slice_report(hostile)],
    )
    concern = report().concerns[0].model_copy(update={"text": hostile})
    page = page_of(report(frame, subject_id=hostile, concerns=[concern], warnings=[hostile]))
    assert "alert('x')" not in page
    assert "alert(&#39;x&#39;)" in page
    assert page.count("<script") == page.count("</script") == 3
    assert "<!--" not in page


@pytest.mark.parametrize(
    "fact",
    [
        "case-01",
        "123.4",
        "56.7",
        "0.25",
        "1.75",
        "5.00",
        "<strong>60.0</strong>",
        "8.25 s",
        "axes LPS",
        "sax-00",
        "6.25",
        "9.35",
        "8.00",
        "3.8",
        "4.15 <small>not followed",
        "27.5",
        "0.37",
        "miss each other by 0.46 mm",
        "&gt; 1000",
        "0.987",
        "0.81",
        "not yet.</strong> 27.5 % are &lt;slivers&gt;.",
        "91.5 mm",
        "segment 7",
        "8.88",
        "There is no lv_epi.",
        "1.50\N{EN DASH}2.50",
        "What to worry about first",
        "ED lv_endo: the surface is not closed.",
        "&lt;script&gt;",
    ],
)
def test_the_page_tells_the_numbers(fact: str) -> None:
    assert fact in page_of(report())


def with_surface(**changes: object) -> Report:
    frame = frame_report(surfaces={Structure.LV_ENDO: surface_report(**changes)})
    return report(frame)


@pytest.mark.parametrize(
    "fact",
    [
        "0.66",
        "4.44",
        "2.8",
        "0.59",
        "0.961",
        "0.894",
        "1.31",
        "1.35",
        "0.0123",
        "24.6",
        "turned by 1.50°",
        "0.10, -0.20, 2.25 mm",
        "free-wall 0.011",
        "no field &lt;there&gt;",
    ],
)
def test_the_page_tells_of_the_reference(fact: str) -> None:
    told = reference_report(not_measured={"curvature": "no field <there>"})
    assert fact in page_of(with_surface(reference=told))
    assert "Against the reference" not in page_of(report())


def test_the_page_tells_of_a_reference_without_curvature() -> None:
    bare = reference_report(
        curvature=None, placement=None, volume_ml=None, volume_difference_percent=None, by_view={}
    )
    page = page_of(with_surface(reference=bare))
    assert "Against the reference" in page
    assert "How differently they bend" not in page


def test_the_page_tells_what_slices_left_out_and_seeds_make_of_it() -> None:
    plain = page_of(report())
    assert "Left out and found again" not in plain
    assert "Spread over the ensemble" not in plain
    frame = frame_report(
        surfaces={
            Structure.LV_ENDO: surface_report(
                held_out_mm=distances(2.34),
                held_out_by_view_mm={"long_axis": distances(1.45)},
                deviation_mm=distances(0.67),
            )
        },
        slices=[slice_report("sax-00", held_out_mm={Structure.LV_ENDO: distances(p95=3.21)})],
    )
    page = page_of(report(frame))
    for number in ("2.34", "1.45", "0.67", "3.21"):
        assert f"<td>{number}</td>" in page


def test_the_page_says_so_where_there_is_nothing_to_worry_about() -> None:
    assert "Nothing stood out" not in page_of(report())
    assert "Nothing stood out" in page_of(report(concerns=[]))


def test_many_warnings_are_listed_in_full() -> None:
    assert "All warnings" not in page_of(report(warnings=["one"] * 9))
    page = page_of(report(warnings=[f"number {n} & more" for n in range(5)]))
    assert page.count("&amp; more</li>") == 5


def test_names_in_messages_are_set_as_code() -> None:
    concern = report().concerns[0].model_copy(update={"text": "set `a < b` and `c`, not ` alone"})
    page = page_of(report(concerns=[concern]))
    assert "set <code>a &lt; b</code> and <code>c</code>, not ` alone" in page


def test_a_shift_that_rounds_to_nothing_has_no_sign() -> None:
    still = slice_report("sax-00", shift_mm=(-0.004, 0.0, -1.006))
    assert "<td>0.00, 0.00, -1.01</td>" in page_of(report(frame_report(slices=[still])))


def test_the_page_can_tell_of_an_open_surface_and_of_no_levels() -> None:
    opened = surface_report(volume_ml=None, watertight=False)
    frame = frame_report(
        surfaces={Structure.LV_ENDO: opened},
        levels=[],
        left_ventricle=left_ventricle_report(0),
        slices=[slice_report("sax-00", contour_residual_mm={}, dice={}, shift_deviation_mm=None)],
    )
    page = page_of(report(frame, function=None))
    assert "<td>no</td>" in page
    assert "Function</h2>" not in page
    assert "Levels of the fit" not in page


def test_the_page_tells_triangles_before_and_after_remeshing() -> None:
    assert "target_edge_mm" in page_of(report())
    assert "<small>before</small>" not in page_of(report())
    even = {
        "quality": EVEN,
        "quality_before_remeshing": UNEVEN,
        "remeshing_distance_mm": distances(0.01, p95=0.04, largest=0.26),
    }
    page = page_of(with_surface(**even).model_copy(update={"options": Options(target_edge_mm=2.0)}))
    assert "<small>before</small>" in page
    assert "<td>27.5</td>" in page
    assert "<td>0.01</td><td>0.26</td>" in page
    parser = _Balanced()
    parser.feed(page)
    assert parser.open == []
