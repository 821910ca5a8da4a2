import plotly.graph_objects as go
import pytest

from schemas.cycle_report import CycleReport
from schemas.vocabulary import Structure
from tests.worker.artifacts.page.measured_cycle import cycle_report, labels_of
from worker.artifacts.frame_times import FrameTimes
from worker.artifacts.page.chart import Chart
from worker.artifacts.page.cycle_charts import cycle_charts

COUNT = 4
TIMES = FrameTimes(tuple(labels_of(COUNT)), (0.0, 40.0, 80.0, 120.0), True)
WITHOUT = FrameTimes(tuple(labels_of(COUNT)), None, True)


def drawn(cycle: CycleReport, times: FrameTimes = TIMES) -> dict[str, Chart]:
    return {one.title: one for one in cycle_charts(cycle, times, "Twist is not seen.")}


def test_plotly_takes_every_chart() -> None:
    """Its own schema is the judge: an attribute that it does not know raises."""
    found = drawn(cycle_report(COUNT))
    assert list(found) == [
        "Volume",
        "Change of area",
        "Area in the 90th-percentile error region",
        "Area in the 75th-percentile curvature region",
        "Shortening, left ventricle",
        "Mass of the wall",
        "Thickening by segment",
        "Thickening at F03",
        "Area strain",
        "Area strain by segment, lv_endo",
        "Mean curvature",
        "Gaussian curvature",
    ]
    for one in found.values():
        go.Figure(one.figure)


@pytest.mark.parametrize(
    ("times", "at", "across"),
    [(TIMES, [0.0, 40.0, 80.0, 120.0], "time, ms"), (WITHOUT, [0.0, 1.0, 2.0, 3.0], "frame")],
)
def test_volumes_are_at_their_times_and_ed_and_es_are_marked(
    times: FrameTimes, at: list[float], across: str
) -> None:
    figure = drawn(cycle_report(COUNT), times)["Volume"].figure
    endo, epi, rv, marks = figure["data"]
    assert [one["name"] for one in (endo, epi, rv)] == ["lv_endo", "lv_epi", "rv_endo"]
    assert (endo["x"], endo["y"]) == (at, [100.0, 80.0, 60.0, 40.0])
    assert (marks["x"], marks["y"]) == ([at[0], at[-1]], [101.25, 41.75])
    assert figure["layout"]["xaxis"]["title"]["text"] == across
    assert figure["layout"]["shapes"][0]["x0"] == at[0]
    assert figure["layout"]["yaxis"]["rangemode"] == "tozero"


def test_what_is_not_observed_is_said_beside_strain() -> None:
    found = drawn(cycle_report(COUNT))
    assert "Twist is not seen." in found["Area strain"].note
    assert "not observed" in found["Area strain by segment, lv_endo"].note
    assert "Twist is not observed" in found["Shortening, left ventricle"].note


def test_a_frame_without_a_number_is_a_gap() -> None:
    shares = drawn(cycle_report(COUNT))["Area in the 90th-percentile error region"]
    assert shares.figure["data"][0]["y"] == [9.0, 9.0, 9.0, None]


def test_a_band_lies_between_its_percentiles() -> None:
    low, high, line = drawn(cycle_report(COUNT))["Area strain"].figure["data"]
    assert high["fill"] == "tonexty"
    for below, middle, above in zip(low["y"], line["y"], high["y"], strict=True):
        assert below < middle < above


def test_what_was_not_measured_is_not_drawn() -> None:
    whole = cycle_report(COUNT)
    nothing: list[float | None] = [None] * COUNT
    surface = whole.surfaces[Structure.LV_ENDO].model_copy(
        update={
            "volume_ml": nothing,
            "area_strain_percent": None,
            "area_strain_by_segment_percent": None,
            "above_p90_error_area_percent": nothing,
            "above_p75_curvature_area_percent": nothing,
        }
    )
    ventricle = whole.left_ventricle.model_copy(
        update={
            "longitudinal_shortening_percent": nothing,
            "circumferential_shortening_percent": nothing,
            "wall_mass_g": nothing,
            "wall_thickening_percent": {},
        }
    )
    bare = whole.model_copy(
        update={
            "chambers": {},
            "surfaces": {Structure.LV_ENDO: surface},
            "left_ventricle": ventricle,
        }
    )
    assert list(drawn(bare)) == ["Change of area", "Mean curvature", "Gaussian curvature"]


def test_segments_are_rows_with_the_first_on_top_and_zero_is_pale() -> None:
    figure = drawn(cycle_report(COUNT))["Thickening by segment"].figure
    (cells,) = figure["data"]
    assert cells["y"] == list(range(1, 18))
    assert cells["z"][2] == [0.0, 13.0, 26.0, 39.0]
    assert cells["zmin"] == -cells["zmax"]
    assert figure["layout"]["yaxis"]["autorange"] == "reversed"
    assert cells["text"][6][0] == "mid anterior"
