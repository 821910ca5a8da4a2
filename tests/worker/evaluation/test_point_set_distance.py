from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.distance import directed_hausdorff

from schemas.problem import InternalError
from worker.evaluation.point_set_distance import point_set_distance


def test_hand_made_sets_have_hand_made_distances():
    first = np.array([[0.0, 0, 0], [10, 0, 0]])
    second = np.array([[3.0, 0, 0], [10, 4, 0]])
    found = point_set_distance(first, second)
    # There: 3, 4. Back: 3, 4.
    assert found.chamfer_mm2 == pytest.approx(25.0)
    assert found.rms_chamfer_mm == pytest.approx(np.sqrt(12.5))
    assert found.hausdorff_mm == pytest.approx(4.0)
    assert found.hausdorff50_mm == pytest.approx(3.5)
    assert found.rmse_mm == pytest.approx(np.sqrt(12.5))
    assert found.mae_mm == pytest.approx(3.5)
    assert found.optimal_threshold_mm == pytest.approx(3.9)


def test_a_set_is_at_no_distance_from_itself():
    points = np.random.default_rng(0).normal(size=(100, 3))
    found = point_set_distance(points, points)
    assert found.chamfer_mm2 == 0.0
    assert found.hausdorff_mm == 0.0


def test_it_is_symmetric_and_agrees_with_scipy():
    generator = np.random.default_rng(1)
    first, second = generator.normal(size=(300, 3)), generator.normal(size=(200, 3)) + 0.5
    found = point_set_distance(first, second)
    turned = point_set_distance(second, first)
    assert found.to_reference == turned.from_reference
    assert found.from_reference == turned.to_reference
    # But for these, and the threshold, which is of the first set alone.
    directed = {name: getattr(found, name) for name in ("to_reference", "from_reference")}
    assert replace(found, optimal_threshold_mm=0.0) == replace(
        turned, optimal_threshold_mm=0.0, **directed
    )
    within = cKDTree(second).query(first)[0] <= found.optimal_threshold_mm
    assert within.mean() == pytest.approx(0.9, abs=0.005)
    there, back = directed_hausdorff(first, second)[0], directed_hausdorff(second, first)[0]
    assert found.hausdorff_mm == pytest.approx(max(there, back))


def test_percentiles_are_in_order():
    generator = np.random.default_rng(2)
    found = point_set_distance(generator.normal(size=(300, 3)), generator.normal(size=(300, 3)))
    assert found.hausdorff50_mm < found.hausdorff90_mm < found.hausdorff95_mm < found.hausdorff_mm


def test_an_empty_set_is_refused():
    with pytest.raises(InternalError, match="without points"):
        point_set_distance(np.zeros((0, 3)), np.zeros((1, 3)))


def test_a_shifted_grid_is_off_by_the_shift_in_every_measure():
    grid = np.stack(np.meshgrid(*[np.arange(6.0)] * 3), axis=-1).reshape(-1, 3)
    found = point_set_distance(grid, grid + np.array([0.25, 0.0, 0.0]))
    assert found.chamfer_mm2 == pytest.approx(2.0 * 0.0625)
    lengths = (found.rms_chamfer_mm, found.hausdorff_mm, found.rmse_mm, found.mae_mm)
    assert lengths == pytest.approx((0.25,) * 4)
    assert found.optimal_threshold_mm == pytest.approx(0.25)


def test_the_root_of_the_mean_square_is_never_below_the_mean():
    generator = np.random.default_rng(3)
    for _ in range(20):
        first, second = generator.normal(size=(2, 50, 3))
        found = point_set_distance(first, second * generator.uniform(0.1, 3.0))
        assert found.rmse_mm >= found.mae_mm


def test_directed_distances_are_those_that_the_others_are_made_of():
    generator = np.random.default_rng(4)
    near, spread = generator.normal(size=(300, 3)), 3.0 * generator.normal(size=(200, 3))
    found = point_set_distance(near, spread)
    there, back = cKDTree(spread).query(near)[0], cKDTree(near).query(spread)[0]
    assert found.to_reference.mean_mm == pytest.approx(there.mean())
    assert found.from_reference.max_mm == pytest.approx(back.max())
    assert (found.to_reference.samples, found.from_reference.samples) == (300, 200)
    ways = found.to_reference, found.from_reference
    assert found.chamfer_mm2 == pytest.approx(sum(way.rms_mm**2 for way in ways))
    assert found.hausdorff90_mm == max(way.p90_mm for way in ways)
    assert found.optimal_threshold_mm == found.to_reference.p90_mm
