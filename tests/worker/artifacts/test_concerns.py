"""Every concern says what, where, how much and what to do; the gravest comes first."""

import re

import pytest

from schemas.frame_report import FrameReport, SliceReport
from schemas.report import Concern, FunctionReport
from schemas.surface_report import SurfaceReport
from schemas.vocabulary import Structure, View
from tests.worker.artifacts.page.example_report import (
    distances,
    frame_report,
    reference_report,
    slice_report,
    surface_report,
)
from worker.artifacts.concerns import concerns

ENDO, EPI = Structure.LV_ENDO, Structure.LV_EPI


def good_slice(slice_id: str = "sax-00", **changes: object) -> SliceReport:
    return slice_report(slice_id, View.SAX, shift_mm=(0.3, 0.4, 0.0)).model_copy(update=changes)


def frame(
    surfaces: dict[Structure, SurfaceReport] | None = None,
    slices: list[SliceReport] | None = None,
    label: str = "ED",
    noise_mm: float | None = 0.2,
) -> FrameReport:
    return frame_report(
        label,
        contour_noise_mm=noise_mm,
        surfaces=surfaces or {ENDO: surface_report()},
        slices=[good_slice()] if slices is None else slices,
    )


def pump(**changes: float) -> FunctionReport:
    usual = {
        "lv_edv_ml": 120.0,
        "lv_esv_ml": 48.0,
        "lv_stroke_volume_ml": 72.0,
        "lv_ejection_fraction_percent": 60.0,
    }
    return FunctionReport.model_validate(usual | changes)


def test_a_good_heart_is_no_concern() -> None:
    """Slivers are not one either: every surface straight from the grid has them."""
    unfit = frame({ENDO: surface_report()})
    assert unfit.surfaces[ENDO].simulation.reasons
    assert concerns([unfit], []) == []
    assert concerns([], []) == []


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"watertight": False, "volume_ml": None}, ["not closed", "no volume"]),
        ({"manifold": False}, ["not manifold"]),
        ({"components": 3}, ["3 pieces"]),
        ({"euler_number": 0}, ["hole or a handle", "Euler number 0 instead of 2"]),
        ({"self_intersecting_triangles": 12}, ["12 of its 16 triangles", "mesh.grid_mm"]),
        ({"volume_ml": 2.0}, ["2.0 mL", "units"]),
        ({"volume_ml": 4321.0}, ["4321.0 mL", "units"]),
        ({"reference": reference_report(hausdorff95_mm=9.0)}, ["reference", "9.0 mm"]),
    ],
)
def test_what_spoils_a_surface_is_grave(changes: dict[str, object], words: list[str]) -> None:
    (found,) = concerns([frame({ENDO: surface_report(**changes)})], [])
    assert found.severity == "grave"
    assert "ED lv_endo" in found.text
    for word in words:
        assert word in found.text


def test_an_open_base_is_no_fault_where_it_was_asked_for() -> None:
    opened = surface_report(watertight=False, volume_ml=None, euler_number=1)
    assert concerns([frame({ENDO: opened})], [], open_base=True) == []
    assert concerns([frame({ENDO: opened})], [])[0].severity == "grave"
    holed = surface_report(watertight=False, volume_ml=None, euler_number=-1)
    assert "instead of 1" in concerns([frame({ENDO: holed})], [], open_base=True)[0].text


def test_a_cavity_larger_than_its_wall_is_grave() -> None:
    swapped = frame({ENDO: surface_report(volume_ml=200.0), EPI: surface_report(volume_ml=120.0)})
    (found,) = concerns([swapped], [])
    assert found.severity == "grave"
    assert "lv_endo" in found.text
    assert "lv_epi" in found.text
    assert "200.0 mL" in found.text
    assert "120.0 mL" in found.text


@pytest.mark.parametrize(
    ("surface", "words"),
    [
        ({"reference": reference_report(hausdorff95_mm=2.5)}, ["2.5 mm", "95th percentile"]),
        ({"held_out_mm": distances(2.0, p95=6.5)}, ["without a slice", "6.5 mm"]),
        ({"deviation_mm": distances(1.0, p95=3.25)}, ["other seeds", "3.2 mm"]),
        ({"crossing_triangles": {EPI: 7}}, ["7 of its 16 triangles", "lv_epi"]),
    ],
)
def test_what_casts_doubt_on_a_surface_is_notable(
    surface: dict[str, object], words: list[str]
) -> None:
    (found,) = concerns([frame({ENDO: surface_report(**surface)})], [])
    assert found.severity == "notable"
    for word in ["ED lv_endo", *words]:
        assert word in found.text


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"contour_residual_mm": {ENDO: distances(p95=0.9, largest=3.5)}}, ["lv_endo", "3.5 mm"]),
        ({"contour_residual_mm": {ENDO: distances(p95=1.5, largest=1.9)}}, ["1.5 mm"]),
        ({"dice": {ENDO: 0.85}}, ["lv_endo", "Dice of 0.85"]),
        ({"shift_mm": (0.0, 6.0, 0.0)}, ["6.0 mm", "± 0.4 mm"]),
        ({"shift_mm": (0.0, 6.0, 0.0), "shift_deviation_mm": None}, ["no long-axis contour"]),
        ({"shift_deviation_mm": 2.5}, ["± 2.5 mm", "6 crossings"]),
    ],
)
def test_a_suspicious_slice_is_named(changes: dict[str, object], words: list[str]) -> None:
    (found,) = concerns([frame(slices=[good_slice("sax-07", **changes)])], [])
    assert found.severity == "notable"
    for word in ["ED", "slice sax-07", *words]:
        assert word in found.text


def test_what_is_just_within_bounds_is_not_named() -> None:
    fair = good_slice(
        contour_residual_mm={ENDO: distances(p95=1.0, largest=2.0)},
        dice={ENDO: 0.9, EPI: None},
        shift_mm=(3.0, 4.0, 0.0),
        shift_deviation_mm=2.0,
    )
    surface = surface_report(
        reference=reference_report(hausdorff95_mm=2.0), held_out_mm=distances(p95=4.0)
    )
    assert concerns([frame({ENDO: surface}, [fair])], []) == []


def test_unsteady_contours_are_not_blamed_one_by_one() -> None:
    """No surface can follow noise; that there is noise is said once, by its own warning."""
    rough = good_slice(contour_residual_mm={ENDO: distances(p95=2.5, largest=4.5)})
    assert len(concerns([frame(slices=[rough], noise_mm=0.2)], [])) == 1
    assert len(concerns([frame(slices=[rough], noise_mm=None)], [])) == 1
    assert concerns([frame(slices=[rough], noise_mm=1.5)], []) == []


def test_two_surfaces_that_cross_are_one_concern() -> None:
    both = frame(
        {
            ENDO: surface_report(crossing_triangles={EPI: 7}),
            EPI: surface_report(crossing_triangles={ENDO: 9}, volume_ml=200.0),
        }
    )
    assert len(concerns([both], [])) == 1


def test_warnings_are_taken_over_word_for_word_and_once() -> None:
    assert concerns([frame()], ["a <b>", "c", "a <b>"]) == [
        Concern(severity="notable", text="a <b>"),
        Concern(severity="notable", text="c"),
    ]


def test_warnings_that_are_alike_are_counted_and_those_of_surfaces_come_first() -> None:
    pairs = [("rv_endo", "lv_epi"), ("lv_endo", "epi"), ("rv_epi", "lv_epi")] * 2
    alike = [f"Slice sax-0{n}: {n} % of {a} lies within {b}." for n, (a, b) in enumerate(pairs)]
    found = concerns([frame(slices=[good_slice(dice={ENDO: 0.8})])], [*alike, "ED: said of it."])
    texts = [one.text for one in found]
    assert texts[0] == "ED: said of it."
    assert "Dice" in texts[1]
    assert texts[2:5] == alike[:3]
    assert texts[5].startswith("And 3 more warnings like these")
    assert len(texts) == 6


def test_the_gravest_comes_first() -> None:
    bad = frame(
        {ENDO: surface_report(watertight=False, volume_ml=None)},
        [good_slice("sax-01", shift_mm=(9.0, 0.0, 0.0), dice={ENDO: 0.2})],
    )
    found = concerns([bad], ["said on the way"])
    assert [one.severity for one in found] == ["grave", "grave", "notable", "notable"]
    assert "not closed" in found[0].text
    assert "Dice of 0.20" in found[1].text
    assert found[2].text == "said on the way"
    assert "9.0 mm" in found[3].text


def test_of_a_kind_the_worst_three_are_named_and_the_rest_counted() -> None:
    slices = [good_slice(f"sax-{n}", shift_mm=(6.0 + n, 0.0, 0.0)) for n in range(6)]
    texts = [one.text for one in concerns([frame(slices=slices)], [])]
    assert [re.findall(r"slice (sax-\d)", text) for text in texts] == [
        ["sax-5"],
        ["sax-4"],
        ["sax-3"],
        [],
    ]
    assert texts[3].startswith("And 3 more")
    # A count of one is no shorter than naming it.
    assert len(concerns([frame(slices=slices[:4])], [])) == 4


def test_the_held_out_slice_that_was_missed_most_is_named() -> None:
    slices = [good_slice(f"sax-{n}", held_out_mm={ENDO: distances(p95=4.0 + n)}) for n in range(3)]
    surface = surface_report(held_out_mm=distances(p95=5.5))
    (found,) = concerns([frame({ENDO: surface}, slices)], [])
    assert "most at slice sax-2 (6.0 mm)" in found.text


@pytest.mark.parametrize(
    ("function", "severity"),
    [
        (pump(lv_ejection_fraction_percent=-5.0), "grave"),
        (pump(lv_ejection_fraction_percent=92.0), "notable"),
        (pump(rv_ejection_fraction_percent=4.0), "notable"),
    ],
)
def test_a_pump_that_no_heart_is(function: FunctionReport, severity: str) -> None:
    (found,) = concerns([frame(), frame(label="ES")], [], function=function)
    assert found.severity == severity
    assert "ejection fraction" in found.text


def test_a_concern_names_the_frames_that_it_is_of() -> None:
    function = pump(lv_ejection_fraction_percent=92.0).model_copy(
        update={"ed_frame": "F00", "es_frame": "F09"}
    )
    (found,) = concerns([frame(label="F00"), frame(label="F09")], [], function=function)
    assert found.text.startswith("F00 and F09: the left ejection fraction is 92.0 %")


def test_no_function_is_a_concern_only_where_both_instants_were_sent() -> None:
    assert concerns([frame()], []) == []
    assert (
        concerns([frame({EPI: surface_report()}), frame({EPI: surface_report()}, label="ES")], [])
        == []
    )
    (found,) = concerns([frame(), frame(label="ES")], [])
    assert "no ejection fraction" in found.text
    assert concerns([frame(), frame(label="ES")], [], function=pump()) == []
