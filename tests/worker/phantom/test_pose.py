import numpy as np

from worker.phantom.pose import Pose


def test_there_and_back_is_identity():
    points = np.random.default_rng(0).normal(scale=50.0, size=(20, 3))
    pose = Pose()
    np.testing.assert_allclose(pose.to_heart(pose.to_patient(points)), points, atol=1e-12)


def test_it_is_a_rotation_and_oblique():
    rotation = Pose().rotation
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) > 0.0
    assert np.abs(rotation).max() < 0.95  # no axis of the heart along one of the patient's


def test_the_apex_points_left_front_and_down_and_the_rv_right():
    rotation = Pose().rotation
    left, back, head = -rotation[:, 2]  # base to apex, LPS
    assert left > 0.0 > back
    assert head < 0.0
    assert rotation[0, 0] < 0.0
