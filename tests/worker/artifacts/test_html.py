import re
from html.parser import HTMLParser

import pytest

from schemas.options import Options
from schemas.report import (
    DistanceSummary,
    FrameReport,
    FunctionReport,
    LevelReport,
    Provenance,
    Report,
    SliceReport,
    SurfaceReport,
)
from schemas.vocabulary import Axes, Structure, View
from worker.artifacts.html import loss_chart, render_html

_DISTANCE = DistanceSummary(mean=0.25, rms=0.3, p95=0.5, max=1.75, count=100)


def _level(index: int, total: float) -> LevelReport:
    return LevelReport(level=index, radius_mm=4.0, samples=9, bce=total, hinge=0.0, total=total)


@pytest.fixture
def report() -> Report:
    surface = SurfaceReport(
        volume_ml=123.4,
        area_cm2=56.7,
        watertight=True,
        vertices=10,
        faces=16,
        euler_number=2,
        contour_residual_mm=_DISTANCE,
        files=["ED_lv_endo.stl"],
    )
    observed = SliceReport(
        id="sax-00",
        view=View.SAX,
        shift_mm=(3.0, 4.0, 0.0),
        contour_residual_mm={Structure.LV_ENDO: _DISTANCE},
    )
    empty = SliceReport(
        id="sax-01", view=View.SAX, shift_mm=(0.0, 0.0, 0.0), contour_residual_mm={}
    )
    frame = FrameReport(
        label="ED",
        time_ms=None,
        surfaces={Structure.LV_ENDO: surface},
        slices=[observed, empty],
        levels=[_level(0, 0.5), _level(1, 0.05)],
    )
    return Report(
        subject_id="case-01",
        axes=Axes.LPS,
        frames=[frame],
        function=FunctionReport(
            lv_edv_ml=120.0,
            lv_esv_ml=48.0,
            lv_stroke_volume_ml=72.0,
            lv_ejection_fraction_percent=60.0,
        ),
        warnings=["only 3 slices <script>alert('x')</script>"],
        timings_s={"fitting": 8.25},
        options=Options(),
        provenance=Provenance(
            software="neuralmri 0.1.0",
            python="3.11",
            libraries={"numpy": "2.4.6"},
            seed=0,
            threads=1,
            input_sha256="0" * 64,
        ),
    )


class _Balanced(HTMLParser):
    """Fails on a closing tag that does not match the last one opened."""

    void = frozenset({"meta", "br", "circle", "polyline"})

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: set[str] = set()

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.seen.add(tag)
        if tag not in self.void:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in self.void:
            assert self.open.pop() == tag


def test_the_page_is_well_formed(report: Report) -> None:
    parser = _Balanced()
    parser.feed(render_html(report))
    assert parser.open == []
    assert {"table", "svg", "polyline"} <= parser.seen


def test_the_page_needs_no_script_and_no_network(report: Report) -> None:
    page = render_html(report)
    assert "<script" not in page
    assert re.findall(r"""(?:src|href)=["']?([^"'>]+)""", page) == ["ED_lv_endo.stl"]
    assert "http" not in page
    assert "@import" not in page


def test_text_of_the_caller_is_escaped(report: Report) -> None:
    assert "&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt;" in render_html(report)


@pytest.mark.parametrize(
    "fact",
    ["case-01", "123.4", "56.7", "0.25", "1.75", "5.00", "60.0 %", "8.25 s", "axes LPS", "sax-01"],
)
def test_the_page_tells_the_numbers(report: Report, fact: str) -> None:
    assert fact in render_html(report)


def test_the_page_says_so_where_there_is_nothing_to_warn_of(report: Report) -> None:
    assert "No warnings." not in render_html(report)
    calm = render_html(report.model_copy(update={"warnings": []}))
    assert "No warnings." in calm
    assert "Please check" not in calm


def test_a_shift_that_rounds_to_nothing_has_no_sign(report: Report) -> None:
    frame = report.frames[0]
    still = frame.slices[0].model_copy(update={"shift_mm": (-0.004, 0.0, -1.006)})
    changed = frame.model_copy(update={"slices": [still]})
    page = render_html(report.model_copy(update={"frames": [changed]}))
    assert "<td>0.00, 0.00, -1.01</td>" in page


def test_the_page_can_tell_of_an_open_surface_and_of_no_levels(report: Report) -> None:
    frame = report.frames[0]
    opened = frame.surfaces[Structure.LV_ENDO].model_copy(
        update={"volume_ml": None, "watertight": False}
    )
    changed = frame.model_copy(update={"surfaces": {Structure.LV_ENDO: opened}, "levels": []})
    page = render_html(report.model_copy(update={"frames": [changed], "function": None}))
    assert "<td>no</td>" in page
    assert "<svg" not in page


def test_a_tenth_of_the_loss_is_as_far_down_at_every_height() -> None:
    chart = loss_chart([_level(0, 1.0), _level(1, 0.1), _level(2, 0.01)])
    (_, top), (_, middle), (_, bottom) = chart.marks
    assert middle - top == pytest.approx(bottom - middle)
    assert top < bottom


@pytest.mark.parametrize("totals", [[], [0.0], [0.2], [0.3, 0.3], [0.0, 0.5]])
def test_a_chart_stays_inside_its_box(totals: list[float]) -> None:
    chart = loss_chart([_level(i, total) for i, total in enumerate(totals)])
    assert len(chart.marks) == len(totals)
    for x, y in chart.marks:
        assert 0 <= x <= chart.width
        assert 0 <= y <= chart.height
