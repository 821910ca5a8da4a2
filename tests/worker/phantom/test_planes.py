import numpy as np
import pytest

from schemas.vocabulary import View
from worker.phantom.long_axis import long_axis
from worker.phantom.planes import long_axis_planes, short_axis_stack


def test_short_axis_planes_are_parallel_evenly_apart_and_within_the_heart(diastole):
    axis = long_axis(diastole)
    planes = short_axis_stack([diastole], axis, 8.0)
    along = np.array([(p.origin_mm - axis.centre_mm) @ axis.towards_base for p in planes])
    np.testing.assert_allclose(np.diff(along), -8.0)
    assert all(np.allclose(p.normal, -axis.towards_base) for p in planes)
    points = np.concatenate([m.vertices_mm for m in diastole.values()])
    height = (points - axis.centre_mm) @ axis.towards_base
    above, below = height.max() - along[0], along[-1] - height.min()
    assert above == pytest.approx(below)
    assert 4.0 <= above < 8.0


def test_a_margin_adds_planes_beyond_both_ends(diastole):
    axis = long_axis(diastole)
    without, with_margin = (short_axis_stack([diastole], axis, 8.0, m) for m in (0.0, 8.0))
    assert len(with_margin) == len(without) + 2


def test_long_axis_planes_hold_the_axis_at_sixty_degrees(diastole):
    axis = long_axis(diastole)
    planes = long_axis_planes(axis, 3)
    assert [p.view for p in planes] == [View.LAX_4CH, View.LAX_2CH, View.LAX_3CH]
    for plane in planes:
        assert abs(plane.normal @ axis.towards_base) < 1e-12
        assert np.linalg.norm(plane.normal) == pytest.approx(1.0)
    assert abs(planes[0].normal @ axis.towards_rv) < 1e-12  # through both ventricles
    normals = np.array([p.normal for p in planes])
    np.testing.assert_allclose(np.abs(np.triu(normals @ normals.T, 1)[np.triu_indices(3, 1)]), 0.5)


def test_none_may_be_asked_for(diastole):
    assert long_axis_planes(long_axis(diastole), 0) == []
