import numpy as np
import pytest

from tests.worker.interpolation.stacks import STRUCTURE, ellipsoid, heights_mm
from worker.interpolation.shape_based import Blend, shape_based


def test_a_cubic_blend_keeps_the_bulge_that_a_linear_one_flattens() -> None:
    truth = ellipsoid(spacing_mm=12.0)
    errors = {}
    for blend in Blend:
        vertices = shape_based(truth.stack, STRUCTURE, blend=blend, cell_mm=2.0).vertices_mm
        errors[blend] = truth.off_mm(vertices[np.abs(heights_mm(vertices)) <= 34.0]).mean()
    assert errors[Blend.LINEAR] <= -0.3
    assert abs(errors[Blend.CUBIC]) <= 0.5 * abs(errors[Blend.LINEAR])


@pytest.mark.parametrize("blend", Blend)
def test_smaller_cells_lie_on_the_same_surface(blend: Blend) -> None:
    truth = ellipsoid(long_axis=False)
    coarse, fine = (
        np.abs(
            truth.off_mm(shape_based(truth.stack, STRUCTURE, blend=blend, cell_mm=c).vertices_mm)
        )
        for c in (2.5, 1.25)
    )
    assert fine.mean() == pytest.approx(coarse.mean(), abs=0.1)
