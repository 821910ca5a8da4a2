"""The bench of a cycle counts what its names say, and reads surfaces as closed ones."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.sequence import beating, ejection_fraction, jitter_ml, measured, surfaces_of
from schemas.options import Options
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import is_watertight
from worker.phantom.slicing_plan import SlicingPlan


def test_jitter_is_nothing_for_a_still_heart_and_grows_with_noise() -> None:
    still = np.full((25, 3), 100.0)
    np.testing.assert_array_equal(jitter_ml(still), 0.0)
    shaken = still + np.random.default_rng(0).normal(size=still.shape)
    # Second differences of independent noise have six times its variance.
    np.testing.assert_allclose(jitter_ml(shaken), 6.0**0.5, rtol=0.4)


def test_the_ejection_fraction_is_of_the_first_surface() -> None:
    assert ejection_fraction(np.array([[100.0, 1.0], [40.0, 1.0], [70.0, 1.0]])) == pytest.approx(
        60
    )


def test_a_beating_phantom_is_measured_frame_by_frame() -> None:
    quick = Options.model_validate(
        {"levels": 1, "iterations_per_level": 40, "mesh": {"grid_mm": 4.0}}
    )
    row = measured(beating(3), SlicingPlan(), quick)
    assert row.distances_mm.shape == row.volumes_ml.shape == (3, 3)
    assert row.distances_mm.max() < 5.0
    assert row.volumes_ml[0, 0] > row.volumes_ml[1, 0]


SURFACES = (
    Path(__file__).parents[2] / "../shared/data/bivme_guide_points/fitted_surfaces_patient1.npz"
)


@pytest.mark.skipif(not SURFACES.is_file(), reason=f"no real cycle at {SURFACES}")
def test_the_surfaces_of_a_real_cycle_are_closed_and_face_outward() -> None:
    frames = surfaces_of(SURFACES)
    assert len(frames) == 25
    for mesh in frames[0].values():
        assert is_watertight(mesh)
        assert volume_ml(mesh) > 50.0
