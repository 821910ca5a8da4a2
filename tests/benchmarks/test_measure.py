"""A method in a process of its own: what it finds, what it costs, how it fails."""

import numpy as np
import pytest

from benchmarks.measure import Failed, Measured, measured
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from tests.benchmarks.trivial_methods import CORNERS_MM, FACES
from worker.phantom import SlicingPlan, heart, slice_meshes

ROOM = "tests.benchmarks.trivial_methods"


@pytest.fixture(scope="module")
def study() -> ContourStudy:
    return slice_meshes(heart(0.0).meshes(4.0), SlicingPlan(spacing_mm=20.0)).study


def test_what_a_method_finds_and_costs(study: ContourStudy) -> None:
    outcome = measured(f"{ROOM}:works", study)
    assert isinstance(outcome, Measured)
    mesh = outcome.found.surfaces[Structure.LV_ENDO]
    np.testing.assert_array_equal(mesh.faces, FACES)
    np.testing.assert_array_equal(mesh.vertices_mm, CORNERS_MM)
    np.testing.assert_array_equal(outcome.found.shifts_mm["sax-00"], [1.0, 2.0, 3.0])
    assert outcome.found.failures == {Structure.LV_EPI: "too few | slices"}
    cost = outcome.cost
    assert 0.2 <= cost.wall_s < 10.0
    assert cost.cpu_s < cost.wall_s  # it mostly slept
    assert 90.0 < cost.peak_mib - cost.libraries_mib < 130.0


def test_a_child_does_not_carry_its_parents_memory(study: ContourStudy) -> None:
    held = np.ones(2**27)  # 1 GiB here, not there
    outcome = measured(f"{ROOM}:works", study)
    assert isinstance(outcome, Measured)
    assert outcome.cost.peak_mib < 800.0 < held.nbytes / 2**20


@pytest.mark.parametrize(
    ("entry", "reason"),
    [
        (f"{ROOM}:raises", "ValueError: phantom is no heart"),
        (f"{ROOM}:dies", "ended with status 7"),
        ("no_such_module:works", "ModuleNotFoundError: No module named 'no_such_module'"),
    ],
)
def test_a_failure_is_a_value_that_says_why(study: ContourStudy, entry: str, reason: str) -> None:
    assert measured(entry, study) == Failed(reason)


def test_a_method_that_does_not_end_has_failed(study: ContourStudy) -> None:
    assert measured(f"{ROOM}:sleeps", study, timeout_s=3.0) == Failed("not done after 3 s")
