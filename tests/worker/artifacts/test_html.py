import re
from html.parser import HTMLParser

import pytest

from schemas.options import Options
from schemas.report import (
    DistanceSummary,
    EndReport,
    FrameReport,
    FunctionReport,
    Histogram,
    LeftVentricleReport,
    LevelReport,
    Provenance,
    QualityReport,
    Report,
    SegmentReport,
    SimulationReport,
    SliceReport,
    SurfaceReport,
    ViewResiduals,
)
from schemas.vocabulary import Axes, Structure, View
from worker.artifacts.html import loss_chart, render_html

_DISTANCE = DistanceSummary(mean=0.25, rms=0.3, p50=0.2, p90=0.45, p95=0.5, max=1.75, count=100)


_EVEN = QualityReport(
    min_angle_deg=31.25,
    min_angle_p5_deg=40.0,
    min_angle_mean_deg=50.0,
    below_20_deg_percent=0.0,
    aspect_ratio_mean=1.06,
    aspect_ratio_p95=1.2,
    aspect_ratio_max=1.9,
    edge_mean_mm=1.95,
    edge_p5_mm=1.5,
    edge_p95_mm=2.5,
)
_UNEVEN = _EVEN.model_copy(update={"below_20_deg_percent": 27.5, "aspect_ratio_max": None})


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
        components=1,
        manifold=True,
        self_intersecting_triangles=0,
        crossing_triangles={},
        simulation=SimulationReport(fit=False, reasons=["27.5 % are <slivers>."]),
        contour_residual_mm=_DISTANCE,
        contour_residual_by_view={
            "short_axis": ViewResiduals(
                summary_mm=_DISTANCE, histogram=Histogram(bin_width_mm=0.1, counts=[9], beyond=0)
            )
        },
        contour_residual_by_region_mm={"apex": _DISTANCE.model_copy(update={"mean": 0.81})},
        quality=_UNEVEN,
        quality_before_remeshing=None,
        remeshing_distance_mm=None,
        support_mm=DistanceSummary(
            mean=2.5, rms=3.0, p50=2.0, p90=5.5, p95=6.25, max=9.35, count=10
        ),
        slice_gap_mm=8.0,
        beyond_slice_gap_percent=3.75,
        apex=EndReport(height_mm=4.15, support_max_mm=9.35, on_long_axis=False),
        base=None,
        files=["ED_lv_endo.stl"],
    )
    observed = SliceReport(
        id="sax-00",
        view=View.SAX,
        shift_mm=(3.0, 4.0, 0.0),
        shift_deviation_mm=0.37,
        crossings=6,
        rotation_deg=0.0,
        contour_residual_mm={Structure.LV_ENDO: _DISTANCE},
        dice={Structure.LV_ENDO: 0.987},
    )
    empty = SliceReport(
        id="sax-01",
        view=View.SAX,
        shift_mm=(0.0, 0.0, 0.0),
        shift_deviation_mm=None,
        crossings=0,
        rotation_deg=0.0,
        contour_residual_mm={},
        dice={},
    )
    frame = FrameReport(
        label="ED",
        time_ms=None,
        contour_noise_mm=0.456,
        surfaces={Structure.LV_ENDO: surface},
        left_ventricle=LeftVentricleReport(
            long_axis_length_mm=91.5,
            sphericity=0.42,
            mid_area_cm2=15.0,
            wall_mass_g=None,
            wall_thickness_mm={
                7: SegmentReport(name="mid anterior", mean_mm=9.12, min_mm=8.5, max_mm=10.25)
            },
            not_measured={"wall_mass_g": "There is no lv_epi."},
        ),
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
    [
        "case-01",
        "123.4",
        "56.7",
        "0.25",
        "1.75",
        "5.00",
        "60.0 %",
        "8.25 s",
        "axes LPS",
        "sax-01",
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
        "lv_endo: not yet.</strong> 27.5 % are &lt;slivers&gt;.",
        "91.5 mm",
        "mid anterior",
        "9.12",
        "There is no lv_epi.",
        "1.50\N{EN DASH}2.50",
    ],
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


def test_the_page_tells_triangles_before_and_after_remeshing(report: Report) -> None:
    assert "target_edge_mm" in render_html(report)
    assert "<small>before</small>" not in render_html(report)
    frame = report.frames[0]
    even = frame.surfaces[Structure.LV_ENDO].model_copy(
        update={
            "quality": _EVEN,
            "quality_before_remeshing": _UNEVEN,
            "remeshing_distance_mm": DistanceSummary(
                mean=0.01, rms=0.02, p50=0.01, p90=0.03, p95=0.04, max=0.26, count=20
            ),
        }
    )
    changed = {
        "frames": [frame.model_copy(update={"surfaces": {Structure.LV_ENDO: even}})],
        "options": Options(target_edge_mm=2.0),
    }
    page = render_html(report.model_copy(update=changed))
    assert "lv_endo <small>before</small>" in page
    assert "<td>27.5</td>" in page
    assert "<td>0.0</td>" in page
    assert "<td>0.01</td><td>0.26</td>" in page
    parser = _Balanced()
    parser.feed(page)
    assert parser.open == []
