"""Records of a case: every surface of every method has one, failed or not."""

import numpy as np
import pytest

from benchmarks.cases import Case
from benchmarks.methods import Method
from benchmarks.run import facts, records
from schemas.vocabulary import Structure
from worker.phantom import SlicingPlan, heart, slice_meshes

ROOM = "tests.benchmarks.trivial_methods"


def method(name: str) -> Method:
    return Method(name, f"{ROOM}:{name}", name, "a test", "nothing")


@pytest.fixture(scope="module")
def case() -> Case:
    truth = heart(0.0).meshes(3.0)
    plan = SlicingPlan(spacing_mm=20.0, shift_sd_mm=2.0)
    sliced = slice_meshes(truth, plan)
    return Case("small", sliced.study, truth, plan, sliced.true_shifts_mm)


def test_every_surface_of_every_method_has_a_record(
    case: Case, capsys: pytest.CaptureFixture[str]
) -> None:
    found = list(records(case, [method("works"), method("raises")]))
    assert [(r.method, r.surface) for r in found] == [
        (name, surface) for name in ("works", "raises") for surface in case.truth
    ]
    endo, epi, rv, *failed = found
    assert endo.surface is Structure.LV_ENDO
    assert endo.failure is None
    assert endo.whole is not None
    assert endo.apex is not None
    assert endo.whole.mean_mm > 10.0
    assert (epi.failure, rv.failure) == ("too few | slices", "no surface")
    assert endo.wall_s == epi.wall_s
    assert {r.failure for r in failed} == {"ValueError: phantom is no heart"}
    assert {r.wall_s for r in failed} == {None}
    assert "small | raises | ValueError" in capsys.readouterr().err


def test_shifts_are_judged_where_there_are_outlines(case: Case) -> None:
    (first, *_) = records(case, [method("works")])
    slices = case.study.frames[0].slices
    found = {"sax-00": np.array([1.0, 2.0, 3.0])}
    left = [
        found.get(s.id, np.zeros(3)) - case.true_shifts_mm[s.id]
        for s in slices
        if s.view == "sax" and s.contours
    ]
    assert first.shift_rms_mm == pytest.approx(np.sqrt(np.mean(np.sum(np.square(left), axis=1))))


def test_facts_of_a_phantom(case: Case) -> None:
    known = facts(case)
    assert known.factors["spacing_mm"] == 20.0
    assert known.long_axis_slices == 3
    assert 1.0 < known.displaced_rms_mm < 6.0
    assert set(known.truth_ml) == set(case.truth)
