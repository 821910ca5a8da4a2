"""The protocols vary one factor at a time; a folder is read as it is."""

import json
from pathlib import Path

import numpy as np
import trimesh

from benchmarks.cases import (
    FACTORS,
    POOREST,
    STANDARD,
    factors,
    folders,
    is_chosen,
    phantoms,
    plan_name,
    protocols,
)
from schemas.vocabulary import Structure
from worker.phantom import SlicingPlan, heart, slice_meshes


def test_the_standard_is_the_projects_own() -> None:
    assert SlicingPlan() == STANDARD


def test_every_factor_is_varied_alone_over_its_range() -> None:
    required = {
        "spacing_mm": {6.0, 8.0, 10.0, 12.0},
        "long_axis_planes": {0, 1, 2, 3},
        "shift_sd_mm": {0.0, 1.5, 3.0},
        "noise_sd_mm": {0.0, 0.5, 1.0},
    }
    assert {name: set(values) for name, values in FACTORS.items()} == required
    for factor, values in required.items():
        alone = {
            getattr(plan, factor)
            for plan in protocols()
            if {**factors(plan), factor: 0} == {**factors(STANDARD), factor: 0}
        }
        assert alone == values


def test_no_protocol_is_run_twice_and_one_is_poor_in_everything() -> None:
    names = [plan_name(plan) for plan in protocols()]
    assert len(names) == len(set(names)) == 12
    assert STANDARD in protocols()
    assert factors(POOREST) == {
        "spacing_mm": 10.0,
        "long_axis_planes": 0,
        "shift_sd_mm": 3.0,
        "noise_sd_mm": 0.0,
    }
    assert POOREST in protocols()


def test_a_phantom_is_sliced_as_its_name_says() -> None:
    (case,) = phantoms(("10 mm 0 LAX",))
    assert case.name == "phantom 10 mm 0 LAX shift 3 mm"
    assert all(slice_.view == "sax" for slice_ in case.study.frames[0].slices)
    assert set(case.true_shifts_mm) >= {slice_.id for slice_ in case.study.frames[0].slices}


def test_a_phantom_in_place_has_no_shifts_to_find() -> None:
    (case,) = phantoms(("12 mm",))
    assert case.true_shifts_mm == {}


def test_a_folder_is_a_case(tmp_path: Path) -> None:
    truth = {Structure.LV_ENDO: heart(0.0).meshes(4.0)[Structure.LV_ENDO]}
    sliced = slice_meshes(truth, SlicingPlan(spacing_mm=20.0, shift_sd_mm=2.0))
    for name in ("one", "other"):
        (tmp_path / name / "reference").mkdir(parents=True)
        (tmp_path / name / "contours.json").write_text(sliced.study.model_dump_json())
        mesh = truth[Structure.LV_ENDO]
        trimesh.Trimesh(mesh.vertices_mm, mesh.faces).export(
            tmp_path / name / "reference" / "lv_endo.ply"
        )
    shifts = {slice_id: shift.tolist() for slice_id, shift in sliced.true_shifts_mm.items()}
    (tmp_path / "one" / "true_shifts_mm.json").write_text(json.dumps(shifts))
    one, other = folders(tmp_path)
    assert (one.name, other.name) == ("one", "other")
    assert list(one.truth) == [Structure.LV_ENDO]
    np.testing.assert_allclose(one.true_shifts_mm["sax-00"], sliced.true_shifts_mm["sax-00"])
    assert other.true_shifts_mm == {}
    assert [case.name for case in folders(tmp_path, ("oth",))] == ["other"]


def test_no_word_chooses_all() -> None:
    assert is_chosen("any", ())
    assert is_chosen("phantom 8 mm", ("6 mm", "8 mm"))
    assert not is_chosen("phantom 8 mm", ("heart",))
