"""The run-time shape checks are on: a wrong shape raises, here and in every other test."""

import numpy as np
import pytest
from jaxtyping import TypeCheckError

from worker.reconstruction.component import outward
from worker.surface_mesh import SurfaceMesh


def test_a_wrong_shape_raises() -> None:
    faces = np.zeros((1, 3), dtype=np.int64)
    with pytest.raises(TypeCheckError):
        outward(np.zeros((4, 2)), faces)
    with pytest.raises(TypeCheckError):
        outward(np.zeros((4, 3)), faces.astype(float))


def test_a_wrong_shape_in_a_value_raises() -> None:
    with pytest.raises(TypeCheckError):
        SurfaceMesh(np.zeros((4, 3)), np.zeros((1, 4), dtype=np.int64))
