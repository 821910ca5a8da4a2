"""What is admitted, with which warnings; what is refused is the catalogue in tests/studies."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from intake.study import admit
from intake.support import frame_surfaces
from schemas.messages import ContourRequest
from schemas.options import Options
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from tests.studies.ellipsoid import good_request

REAL = Path(__file__).parents[3] / "shared" / "data"
REAL_STUDIES = sorted([*REAL.glob("cases/*/contours.json"), *REAL.glob("sunnybrook/*.json")])

Change = Callable[[list[dict[str, Any]]], object]


def warnings_after(change: Change) -> list[str]:
    """Warnings about the good study, its slices changed."""
    raw = good_request()
    change(raw["study"]["frames"][0]["slices"])
    request = ContourRequest.model_validate(raw)
    return admit(request.study, request.options)


def study_of(raw: dict[str, Any]) -> ContourStudy:
    return ContourStudy.model_validate(raw["study"])


@pytest.mark.skipif(not REAL_STUDIES, reason=f"no real studies at {REAL}")
def test_every_real_study_is_admitted() -> None:
    for path in REAL_STUDIES:
        study = ContourStudy.model_validate_json(path.read_bytes())
        warnings = admit(study, Options())
        assert [w for w in warnings if "will not be reconstructed" not in w] == [], path


@pytest.mark.skipif(not REAL_STUDIES, reason=f"no real studies at {REAL}")
@pytest.mark.parametrize(
    "units", [("mm", "cm", 0.1), ("mm", "m", 1e-3), ("mm", "um", 1e3)], ids=lambda u: u[1]
)
def test_real_studies_are_admitted_in_every_unit(units: tuple[str, str, float]) -> None:
    _, unit, factor = units
    for path in REAL_STUDIES:
        raw = json.loads(path.read_bytes())
        raw["units"] = unit
        for s in (s for f in raw["frames"] for s in f["slices"]):
            s["origin"] = [v * factor for v in s["origin"]]
            for c in s["contours"]:
                c["points"] = [[v * factor for v in p] for p in c["points"]]
        admit(ContourStudy.model_validate(raw), Options())


def fitted(slices: list[dict[str, Any]]) -> None:
    for s in slices:
        del s["origin"], s["normal"]


def closing_points_repeated(slices: list[dict[str, Any]]) -> None:
    for c in (c for s in slices for c in s["contours"]):
        c["points"].append(c["points"][0])


def points_repeated(slices: list[dict[str, Any]]) -> None:
    for c in (c for s in slices for c in s["contours"]):
        c["points"] = [p for p in c["points"] for _ in range(3)]


def clockwise_and_anticlockwise(slices: list[dict[str, Any]]) -> None:
    for c in slices[1]["contours"]:
        c["points"].reverse()


def open_at_the_valves(slices: list[dict[str, Any]]) -> None:
    for c in slices[5]["contours"]:
        c["closed"] = False
        c["points"] = c["points"][14:] + c["points"][:7]


def one_point_missing(slices: list[dict[str, Any]]) -> None:
    for c in slices[1]["contours"]:
        del c["points"][5]
        c["points"].pop()


def sparse_triangle(slices: list[dict[str, Any]]) -> None:
    points = slices[2]["contours"][0]["points"]
    slices[2]["contours"][0]["points"] = [points[0], points[13], points[27]]


def a_hole_and_a_second_part(slices: list[dict[str, Any]]) -> None:
    epi = slices[2]["contours"][2]["points"]
    middle = [[-50 + 0.3 * (x + 50), 0.3 * y, z] for x, y, z in epi]
    apart = [[x - 50, y, z] for x, y, z in epi]
    slices[2]["contours"] += [
        {"structure": "rv_endo", "points": middle},
        {"structure": "rv_endo", "points": apart},
    ]
    # The long-axis plane would rightly miss the second part.
    del slices[5]


def pixel_spike(slices: list[dict[str, Any]]) -> None:
    points = slices[2]["contours"][0]["points"]
    tip = [1.1 * v for v in points[9]]
    points[10:10] = [tip, points[9]]


def plane_of_a_far_origin(slices: list[dict[str, Any]]) -> None:
    for s in slices[:5]:
        s["origin"] = [300.0, -300.0, s["origin"][2]]
        s["normal"] = [0.0, 0.0, -1e-3]


def empty_slice_past_the_apex(slices: list[dict[str, Any]]) -> None:
    absent = ["lv_endo", "lv_epi", "rv_endo"]
    slices.append({"id": "past", "origin": [0, 0, -60], "normal": [0, 0, 1], "absent": absent})


def structures_in_slices_of_their_own(slices: list[dict[str, Any]]) -> None:
    slices.append({**slices[2], "id": "rv", "contours": slices[2]["contours"][2:]})
    del slices[2]["contours"][2:]


def slightly_off_plane(slices: list[dict[str, Any]]) -> None:
    for k, p in enumerate(slices[2]["contours"][0]["points"]):
        p[2] += 0.7 * math.sin(k)


def shifted_slices(slices: list[dict[str, Any]]) -> None:
    for k, s in enumerate(slices[:5]):
        for p in (p for c in s["contours"] for p in c["points"]):
            p[0] += 3.0 * math.sin(5.0 * k)


@pytest.mark.parametrize(
    "change",
    [
        fitted,
        closing_points_repeated,
        points_repeated,
        clockwise_and_anticlockwise,
        open_at_the_valves,
        one_point_missing,
        sparse_triangle,
        a_hole_and_a_second_part,
        pixel_spike,
        plane_of_a_far_origin,
        empty_slice_past_the_apex,
        structures_in_slices_of_their_own,
        slightly_off_plane,
        shifted_slices,
    ],
)
def test_what_real_contours_look_like_is_admitted_without_a_warning(change: Change) -> None:
    assert warnings_after(change) == []


@pytest.mark.parametrize("factor", [0.06, 0.1, 1.0, 2.0])
def test_hearts_of_mouse_and_horse_are_admitted_and_small_ones_remarked(factor: float) -> None:
    def scale(slices: list[dict[str, Any]]) -> None:
        for s in slices:
            s["origin"] = [factor * v for v in s["origin"]]
            for c in s["contours"]:
                c["points"] = [[factor * v for v in p] for p in c["points"]]

    remarked = any("small animal" in w for w in warnings_after(scale))
    assert remarked == (factor < 0.2)


def slight_crossing(slices: list[dict[str, Any]]) -> None:
    points = slices[2]["contours"][0]["points"]
    points[9], points[10] = points[10], points[9]


def grazed_cavity_drawn_shakily(slices: list[dict[str, Any]]) -> None:
    outline = [(0.8 * math.cos(0.3 * k), 5 * math.sin(0.3 * k)) for k in range(21)]
    slices[0]["contours"][2]["points"] = [
        [-45 + x + 1.1 * math.sin(40 * k), y, -24.0] for k, (x, y) in enumerate(outline)
    ]


def slightly_outside(slices: list[dict[str, Any]]) -> None:
    for p in slices[2]["contours"][0]["points"]:
        p[0] += 12.0


def thin_sliver_of_a_cavity(slices: list[dict[str, Any]]) -> None:
    slices[0]["contours"][2]["points"] = [
        [-18.5 + 0.8 * math.cos(t), 5 * math.sin(t), -24.0] for t in [0.3 * k for k in range(21)]
    ]


def repeated_slice(slices: list[dict[str, Any]]) -> None:
    slices.append({**slices[2], "id": "again"})


def long_axis_moved(slices: list[dict[str, Any]]) -> None:
    for p in (p for c in slices[5]["contours"] for p in c["points"]):
        p[0] += 14.0


def listed_absent_alone(slices: list[dict[str, Any]]) -> None:
    slices[0]["absent"] = ["rv_epi"]


def two_slices_of_one(slices: list[dict[str, Any]]) -> None:
    for s in slices[2:]:
        del s["contours"][2]


def one_slice_of_one(slices: list[dict[str, Any]]) -> None:
    for s in slices[1:]:
        del s["contours"][2]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (slight_crossing, "crosses itself slightly"),
        (grazed_cavity_drawn_shakily, "crosses itself slightly"),
        (slightly_outside, "of lv_endo lies outside lv_epi"),
        (thin_sliver_of_a_cavity, "of rv_endo lies within lv_epi"),
        (repeated_slice, "sax-02 and again outline lv_endo on the same plane"),
        (long_axis_moved, "slice lax-00 disagrees most"),
        (listed_absent_alone, "rv_epi is listed absent but outlined nowhere"),
        (two_slices_of_one, "rv_endo has contours on 2 planes only"),
    ],
)
def test_what_is_doubtful_is_admitted_with_a_warning(change: Change, said: str) -> None:
    assert [w for w in warnings_after(change) if said in w] != []


@pytest.mark.parametrize(
    ("units", "factor", "said"),
    [
        ("mm", 1e-3, 'look like metres: set units to "m"'),
        ("mm", 1e3, 'look like micrometres: set units to "um"'),
        ("m", 1.0, 'look like millimetres: set units to "mm"'),
        ("cm", 1.0, 'look like millimetres: set units to "mm"'),
        ("m", 0.1, 'look like centimetres: set units to "cm"'),
        ("mm", 1e-7, "no unit makes it a heart"),
    ],
)
def test_a_wrong_unit_is_named_with_the_right_one(units: str, factor: float, said: str) -> None:
    raw = good_request()
    raw["study"]["units"] = units
    for s in raw["study"]["frames"][0]["slices"]:
        s["origin"] = [factor * v for v in s["origin"]]
        for c in s["contours"]:
            c["points"] = [[factor * v for v in p] for p in c["points"]]
    with pytest.raises(InputError) as caught:
        admit(study_of(raw), Options())
    assert caught.value.type is ProblemType.IMPLAUSIBLE_SIZE
    assert said in caught.value.detail


def test_a_surface_needs_two_distinct_planes() -> None:
    raw = good_request()
    one_slice_of_one(raw["study"]["frames"][0]["slices"])
    (frame,) = study_of(raw).frames
    assert frame_surfaces(frame, Options()) == [Structure.LV_ENDO, Structure.LV_EPI]
    with pytest.raises(InputError, match=r"rv_endo contours on 2.*supports \(lv_endo, lv_epi\)"):
        admit(study_of(raw), Options(surfaces=["rv_endo"]))


def test_each_frame_yields_what_it_supports() -> None:
    raw = good_request()
    frames = raw["study"]["frames"]
    frames.append({**good_request()["study"]["frames"][0], "label": "ES"})
    for s in frames[1]["slices"]:
        s["contours"] = s["contours"][:1]
    study = study_of(raw)
    assert frame_surfaces(study.frames[0], Options(surfaces=["lv_epi"])) == [Structure.LV_EPI]
    assert frame_surfaces(study.frames[1], Options()) == [Structure.LV_ENDO]
    assert admit(study, Options()) == [
        "Frame ES: lv_epi, rv_endo will not be reconstructed, having contours on fewer than 2 "
        "distinct planes."
    ]
    assert admit(study, Options(surfaces=["lv_endo"])) == []


def test_pointers_start_where_the_study_stands() -> None:
    raw = good_request()
    raw["study"]["frames"][0]["slices"][3]["contours"][1]["points"][17][2] += 4.0
    with pytest.raises(InputError) as caught:
        admit(study_of(raw), Options(), pointer="")
    assert caught.value.pointer == "/frames/0/slices/3/contours/1/points/17"


def test_a_turned_and_moved_study_is_judged_alike() -> None:
    """A quarter turn about x and a shift: patient axes mean nothing to a heart."""
    raw = good_request()
    for s in raw["study"]["frames"][0]["slices"]:
        s["origin"] = [s["origin"][0] + 500, -s["origin"][2] - 70, s["origin"][1]]
        s["normal"] = [s["normal"][0], -s["normal"][2], s["normal"][1]]
        for c in s["contours"]:
            c["points"] = [[x + 500, -z - 70, y] for x, y, z in c["points"]]
    assert admit(study_of(raw), Options()) == []
