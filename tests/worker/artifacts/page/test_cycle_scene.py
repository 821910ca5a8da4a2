import base64

import numpy as np
import plotly.graph_objects as go
import pytest

from schemas.vocabulary import Structure
from tests.worker.artifacts.page.measured_cycle import measured_cycle
from worker.artifacts.display_meshes import display_meshes
from worker.artifacts.measured import Measured
from worker.artifacts.page.cycle_page import CyclePage, cycle_page
from worker.artifacts.page.frame_page import FramePage
from worker.artifacts.page.scene import scene


@pytest.fixture(scope="module")
def measured() -> Measured:
    return measured_cycle()


def paged(measured: Measured) -> CyclePage:
    thinned, axes = display_meshes(measured), measured.report.axes
    pages = [
        FramePage(f"frame{n}", report, scene(frame, thinned[frame.label], axes, 2000), [], [])
        for n, (report, frame) in enumerate(
            zip(measured.report.frames, measured.frames, strict=True)
        )
    ]
    found = cycle_page(measured, pages)
    assert found is not None
    return found


def test_tracked_vertices_are_where_they_are_in_every_frame(measured: Measured) -> None:
    page = paged(measured)
    assert page.scene is not None
    endo = page.scene["surfaces"][0]
    packed = endo["positions"]
    steps = np.frombuffer(base64.b64decode(packed["bdata"]), "<u2").astype(float)
    planes = (packed["origin"] + packed["step"] * steps).reshape(4, 3, -1)
    whole = measured.tracked[Structure.LV_ENDO].vertices_mm
    assert np.abs(planes - np.moveaxis(whole, 2, 1)).max() <= packed["step"]
    assert packed["step"] < 0.01
    assert endo["shown"] == [0, 1, 2, 3]


def test_other_surfaces_are_those_of_the_frames_and_not_in_the_page_twice(
    measured: Measured,
) -> None:
    page = paged(measured)
    assert page.scene is not None
    epi = page.scene["surfaces"][1]
    assert epi["structure"] == "lv_epi"
    assert "positions" not in epi
    assert [place["scene"] for place in epi["own"]] == [f"frame{n}-scene" for n in range(4)]
    first = measured.frames[0]
    for place in epi["own"]:
        thinned = display_meshes(measured)[first.label]
        traces = scene(first, thinned, measured.report.axes, 2000)["data"]
        assert traces[place["trace"]]["name"] == "lv_epi"


def test_the_view_holds_all_frames_and_stays(measured: Measured) -> None:
    page = paged(measured)
    assert page.scene is not None
    view = page.scene["layout"]["scene"]
    low, high = np.array([view[f"{name}axis"]["range"] for name in "xyz"]).T
    for one in page.moving:
        for mesh in one.meshes:
            assert (mesh.vertices_mm > low).all()
            assert (mesh.vertices_mm < high).all()
    go.Figure(data=[one["trace"] for one in page.scene["surfaces"]], layout=page.scene["layout"])


@pytest.mark.parametrize(
    ("times", "said", "period_s"),
    [(True, "F01, 40 ms", 0.16), (False, "F01, 2 of 4", 1.0)],
)
def test_it_is_said_which_frame_is_shown(times: bool, said: str, period_s: float) -> None:
    page = paged(measured_cycle(times=times))
    assert page.scene is not None
    assert page.scene["frames"][1]["said"] == said
    assert page.scene["period_s"] == period_s
    assert len(page.scene["seconds"]) == 4


def test_two_frames_are_no_cycle(measured: Measured) -> None:
    assert cycle_page(measured, []) is None
