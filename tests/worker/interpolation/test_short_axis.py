from dataclasses import replace

import numpy as np
import pytest

from schemas.problem import InputError, ProblemType
from tests.worker.interpolation.stacks import STRUCTURE, TURN, cylinder
from worker.interpolation.short_axis import short_axis_stack


def test_slices_are_ordered_and_come_back_to_where_they_were() -> None:
    stack = cylinder()
    shuffled = replace(stack, slices=tuple(stack.slices[i] for i in (3, 0, 4, 1, 2)))
    slices = short_axis_stack(shuffled, STRUCTURE)
    np.testing.assert_allclose(np.diff(slices.heights_mm), 8.0)
    back = slices.to_space(slices.outline_points[:, :2], slices.outline_points[:, 2])
    wanted = stack.points_mm
    order = np.lexsort(back.round(6).T), np.lexsort(wanted.round(6).T)
    np.testing.assert_allclose(back[order[0]], wanted[order[1]], atol=1e-6)


@pytest.mark.parametrize(
    ("absent", "reaches"),
    [((), (4.0, 4.0)), ((-3.0,), (1.5, 4.0)), ((-30.0, 36.0), (4.0, 2.0)), ((8.5,), (4.0, 4.0))],
)
def test_it_ends_half_a_gap_out_or_halfway_to_an_empty_slice(
    absent: tuple[float, ...], reaches: tuple[float, float]
) -> None:
    slices = short_axis_stack(cylinder(absent=absent), STRUCTURE)
    # The first slice shown is the origin, and the base's normal is its own.
    ends = slices.heights_mm[0] - slices.bottom_mm, slices.top_mm - slices.heights_mm[-1]
    assert ends == pytest.approx(reaches)
    assert slices.gap_mm == pytest.approx(8.0)


def test_normals_may_point_either_way() -> None:
    stack = cylinder()
    turned = tuple(replace(s, normal=-s.normal) if i % 2 else s for i, s in enumerate(stack.slices))
    slices = short_axis_stack(replace(stack, slices=turned), STRUCTURE)
    np.testing.assert_allclose(slices.heights_mm, [0.0, 8.0, 16.0, 24.0, 32.0], atol=1e-9)


def test_one_plane_twice_is_refused() -> None:
    stack = cylinder()
    doubled = (*stack.slices, replace(stack.slices[2], id="again"))
    with pytest.raises(InputError, match="again") as caught:
        short_axis_stack(replace(stack, slices=doubled), STRUCTURE)
    assert caught.value.type is ProblemType.CONTRADICTING_SLICES


def test_a_plane_that_leans_is_refused() -> None:
    stack = cylinder()
    leaning = TURN @ np.array([0.0, np.sin(0.3), np.cos(0.3)])
    slices = (*stack.slices[:4], replace(stack.slices[4], normal=leaning))
    with pytest.raises(InputError, match="leans 17 degrees"):
        short_axis_stack(replace(stack, slices=slices), STRUCTURE)
