import base64
import copy
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest

from schemas.vocabulary import Axes, Structure
from tests.worker.artifacts.page.measured_phantom import measured_phantom
from worker.artifacts.measured import FIELDS, MeasuredFrame
from worker.artifacts.page.colourings import _LOOKS
from worker.artifacts.page.scene import scene
from worker.surface_mesh import SurfaceMesh


@pytest.fixture(scope="module")
def frame() -> MeasuredFrame:
    (only,) = measured_phantom(edge_mm=3.0).frames
    return only


@pytest.fixture(scope="module")
def drawn(frame: MeasuredFrame) -> dict[str, Any]:
    return scene(frame, whole(frame), Axes.LPS, 2000)


def whole(frame: MeasuredFrame) -> dict[Structure, SurfaceMesh]:
    return {structure: surface.mesh for structure, surface in frame.surfaces.items()}


def numbers(packed: dict[str, str]) -> np.ndarray:
    return np.frombuffer(base64.b64decode(packed["bdata"]), f"<{packed['dtype']}")


def test_plotly_takes_it_with_every_colouring(drawn: dict[str, Any]) -> None:
    """Its own schema is the judge: an attribute that it does not know raises."""
    for colouring in [None, *drawn["colourings"]]:
        # plotly.py takes what it is given apart.
        data, layout = copy.deepcopy(drawn["data"]), copy.deepcopy(drawn["layout"])
        if colouring:
            data = [
                {
                    **trace,
                    "intensity": colouring["values"][str(n)],
                    "intensitymode": colouring["mode"],
                    "coloraxis": "coloraxis",
                }
                if str(n) in colouring["values"]
                else trace
                for n, trace in enumerate(data)
            ]
            layout["coloraxis"] = colouring["coloraxis"]
        go.Figure(data=data, layout=layout)


def test_layers_name_what_is_in_the_data(drawn: dict[str, Any]) -> None:
    named = {
        trace: (s, layer)
        for s, layers in drawn["layers"].items()
        for layer, trace in layers.items()
    }
    assert sorted(named) == list(range(len(drawn["data"]))) == list(range(9))
    for trace, (structure, layer) in named.items():
        assert drawn["data"][trace]["name"].startswith(structure)
        assert drawn["data"][trace]["type"] == ("scatter3d" if layer == "contours" else "mesh3d")


def test_numbers_fit_vertices_and_faces(drawn: dict[str, Any], frame: MeasuredFrame) -> None:
    there = {name for one in frame.surfaces.values() for name in one.fields}
    assert {one["name"] for one in drawn["colourings"]} == there
    for colouring in drawn["colourings"]:
        assert colouring["hint"].startswith(f"{colouring['name']}: ")
        for trace, packed in colouring["values"].items():
            values = numbers(packed)
            mesh = drawn["data"][int(trace)]
            assert len(values) == len(numbers(mesh["x" if colouring["mode"] == "vertex" else "i"]))
            assert np.isfinite(values).all()


def test_every_field_has_a_look() -> None:
    assert set(_LOOKS) == set(FIELDS)


def test_meshes_and_contours_are_thinned_out_and_every_contour_is_there(
    drawn: dict[str, Any], frame: MeasuredFrame
) -> None:
    for structure, layers in drawn["layers"].items():
        assert len(numbers(drawn["data"][layers["surface"]]["i"])) <= 2000
        assert len(numbers(drawn["data"][layers["reference"]]["i"])) <= 1000
        x = numbers(drawn["data"][layers["contours"]]["x"])
        outlines = [r.outline for r in frame.surfaces[structure].residuals]
        points = sum(len(one.points_mm) + one.closed for one in outlines)
        assert 3 * len(outlines) < np.isfinite(x).sum() < points
        assert np.isnan(x).sum() == len(outlines)


@pytest.mark.parametrize(("axes", "front"), [(Axes.LPS, -1.0), (Axes.RAS, 1.0)])
def test_the_camera_is_in_front_and_axes_say_where_they_go(
    frame: MeasuredFrame, axes: Axes, front: float
) -> None:
    view = scene(frame, whole(frame), axes, 500)["layout"]["scene"]
    assert view["camera"]["eye"]["y"] * front > 1.0
    assert view["aspectmode"] == "data"
    titles = [view[f"{name}axis"]["title"]["text"] for name in "xyz"]
    assert titles[2] == "z, mm, to the head"
    assert ("left" in titles[0]) == (axes is Axes.LPS)
    assert ("back" in titles[1]) == (axes is Axes.LPS)


def test_there_need_be_neither_contours_nor_reference_nor_fields(frame: MeasuredFrame) -> None:
    endo = frame.surfaces[Structure.LV_ENDO]
    bare = MeasuredFrame("ED", {Structure.LV_ENDO: type(endo)(endo.mesh, {}, [], None)}, [])
    drawn = scene(bare, whole(bare), Axes.LPS, 2000)
    assert len(drawn["data"]) == 1
    assert drawn["colourings"] == []
