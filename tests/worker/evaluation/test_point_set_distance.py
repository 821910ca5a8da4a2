import numpy as np
import pytest
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


def test_a_set_is_at_no_distance_from_itself():
    points = np.random.default_rng(0).normal(size=(100, 3))
    found = point_set_distance(points, points)
    assert found.chamfer_mm2 == 0.0
    assert found.hausdorff_mm == 0.0


def test_it_is_symmetric_and_agrees_with_scipy():
    generator = np.random.default_rng(1)
    first, second = generator.normal(size=(300, 3)), generator.normal(size=(200, 3)) + 0.5
    found = point_set_distance(first, second)
    assert found == point_set_distance(second, first)
    there, back = directed_hausdorff(first, second)[0], directed_hausdorff(second, first)[0]
    assert found.hausdorff_mm == pytest.approx(max(there, back))


def test_percentiles_are_in_order():
    generator = np.random.default_rng(2)
    found = point_set_distance(generator.normal(size=(300, 3)), generator.normal(size=(300, 3)))
    assert found.hausdorff50_mm < found.hausdorff90_mm < found.hausdorff95_mm < found.hausdorff_mm


def test_an_empty_set_is_refused():
    with pytest.raises(InternalError, match="without points"):
        point_set_distance(np.zeros((0, 3)), np.zeros((1, 3)))
