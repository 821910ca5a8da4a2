import base64

import numpy as np
import plotly.graph_objects as go
import pytest

from schemas.measures import Histogram
from schemas.surface_report import ViewResiduals
from schemas.vocabulary import Structure
from tests.worker.artifacts.page.example_report import (
    distances,
    frame_report,
    left_ventricle_report,
    level_report,
    surface_report,
)
from tests.worker.artifacts.page.measured_phantom import measured_phantom
from worker.artifacts.measured import MeasuredFrame
from worker.artifacts.page.bullseye import segment_angles_deg, thickness_chart
from worker.artifacts.page.charts import charts
from worker.artifacts.page.histograms import distance_chart, residual_chart
from worker.artifacts.page.losses import loss_chart


def test_plotly_takes_every_chart() -> None:
    """Its own schema is the judge: an attribute that it does not know raises."""
    measured = measured_phantom(edge_mm=5.0)
    drawn = charts(measured.report.frames[0], measured.frames[0], 1e-4)
    assert [one.title for one in drawn] == [
        "Reference distance, lv_endo",
        "Reference distance, lv_epi",
        "Reference distance, rv_endo",
        "Contour residual, lv_endo",
        "Contour residual, lv_epi",
        "Contour residual, rv_endo",
        "Wall thickness, left ventricle",
        "Loss of the fit",
    ]
    for one in drawn:
        go.Figure(one.figure)


def test_nothing_is_drawn_of_nothing() -> None:
    bare = frame_report(
        surfaces={Structure.LV_ENDO: surface_report(contour_residual_by_view={})},
        left_ventricle=left_ventricle_report(0),
        levels=[],
    )
    assert charts(bare, MeasuredFrame("ED", {}, []), 1e-4) == []


def test_losses_follow_each_other_and_the_hinge_is_weighted() -> None:
    chart = loss_chart([level_report(0, 0.5), level_report(1, 0.05)], 1e-2)
    assert chart is not None
    lines = {
        one["name"]: np.frombuffer(base64.b64decode(one["y"]["bdata"]), "<f4")
        for one in chart.figure["data"]
    }
    assert all(len(line) == 40 for line in lines.values())
    assert lines["total"][[0, 20]] == pytest.approx([1.0, 0.1])
    hinge = lines["weighted hinge"]
    assert np.isnan(hinge[:10]).all()  # a logarithm has no zero
    assert hinge[10] == pytest.approx(3e-2)
    assert "not drawn" not in chart.note
    layout = chart.figure["layout"]
    assert layout["yaxis"]["type"] == "log"
    assert [(one["x0"], one["x1"]) for one in layout["shapes"]] == [(20.5, 40.5)]
    assert [(one["x"], one["text"]) for one in layout["annotations"]] == [(10.5, "0"), (30.5, "1")]


def test_a_hinge_that_hardly_counts_does_not_stretch_the_axis() -> None:
    chart = loss_chart([level_report(0, 0.5)], 1e-4)
    assert chart is not None
    assert [one["name"] for one in chart.figure["data"]] == ["total", "cross-entropy"]
    assert "not drawn" in chart.note


def test_a_histogram_is_in_percent_of_its_own_view_and_stops_where_the_tail_is_thin() -> None:
    spread = Histogram(bin_width_mm=0.1, counts=[150, 45, 4] + [0] * 46 + [1], beyond=0)
    view = ViewResiduals(summary_mm=distances(), histogram=spread)
    chart = residual_chart("lv_endo", {"short_axis": view, "long_axis": view})
    assert chart is not None
    for bars in chart.figure["data"]:
        assert bars["y"][:3] == [75.0, 22.5, 2.0]
        assert sum(bars["y"]) == pytest.approx(100.0)
    assert chart.figure["layout"]["xaxis"]["range"] == [0, pytest.approx(1.0)]


def test_a_far_tail_ends_the_axis_with_the_bins() -> None:
    chart = distance_chart("lv_endo", np.array([0.1, 99.0, np.nan]))
    assert chart.figure["layout"]["xaxis"]["range"] == [0, pytest.approx(5.0)]
    assert chart.figure["data"][0]["y"][1] == 50.0


def test_segments_fill_each_ring_once_and_lie_where_the_standard_puts_them() -> None:
    for ring in (range(1, 7), range(7, 13), range(13, 17), range(17, 18)):
        angles = [segment_angles_deg(n) for n in ring]
        assert sum(width for _, width in angles) == 360.0
        starts = sorted((middle - width / 2.0) % 360.0 for middle, width in angles)
        assert np.allclose(np.diff(starts), angles[0][1])
    middle = {n: segment_angles_deg(n)[0] % 360.0 for n in range(1, 18)}
    assert middle[1] == middle[7] == middle[13] == 90.0  # anterior, on top
    assert middle[14] == 180.0  # septal, left
    assert middle[4] == middle[10] == middle[15] == 270.0  # inferior
    assert middle[16] == 0.0  # lateral, right
    assert 90.0 < middle[2] < 180.0 < middle[3] < 270.0  # anteroseptal above inferoseptal
    assert 270.0 < middle[5] < 360.0  # inferolateral
    assert 0.0 < middle[6] < 90.0  # anterolateral


def test_segments_that_were_not_measured_are_left_blank() -> None:
    segments = left_ventricle_report().wall_thickness_mm or {}
    chart = thickness_chart({n: segments[n] for n in (1, 17)})
    assert chart is not None
    wedges, labels = chart.figure["data"]
    assert wedges["base"] == [3.0, 0.0]
    assert labels["text"] == ["8.1", "10.1"]
    assert thickness_chart({}) is None
