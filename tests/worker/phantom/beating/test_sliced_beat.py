import numpy as np
import pytest

from schemas.problem import InputError
from worker.evaluation.distance import points_to_surface_mm
from worker.phantom import SlicingPlan
from worker.phantom.beating import sliced_beat


@pytest.fixture(scope="module")
def beat(healthy):
    return sliced_beat(healthy, 4, SlicingPlan(spacing_mm=12.0, shift_sd_mm=2.0), edge_mm=3.0)


def test_frames_are_named_and_timed(beat):
    assert beat.labels == ("F00", "F01", "F02", "F03")
    assert [f.time_ms for f in beat.sliced.study.frames] == beat.times_ms.tolist()
    np.testing.assert_allclose(beat.times_ms, [0.0, 250.0, 500.0, 750.0])


def test_contours_without_their_slice_displacement_lie_on_the_frame_own_surface(beat):
    frames = beat.frames()
    for frame in beat.sliced.study.frames:
        for one in frame.slices:
            for contour in one.contours:
                points = np.array(contour.points) - beat.sliced.true_shifts_mm[one.id]
                off = points_to_surface_mm(points, frames[frame.label][contour.structure])
                assert off.max() < 3e-4


def test_labels_have_as_many_digits_as_they_need(healthy):
    plan = SlicingPlan(spacing_mm=40.0, long_axis_planes=0, point_spacing_mm=10.0)
    labels = sliced_beat(healthy, 101, plan, edge_mm=5.0).labels
    assert (labels[0], labels[-1]) == ("F000", "F100")


@pytest.mark.parametrize("count", [0, 201])
def test_a_count_out_of_bounds_is_refused(healthy, count):
    with pytest.raises(InputError, match=f"frames = {count}; choose between 1 and 200"):
        sliced_beat(healthy, count)
