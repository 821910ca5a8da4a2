import base64

import numpy as np
import pytest

from worker.artifacts.page.typed_arrays import (
    Form,
    coordinates,
    corners,
    index_form,
    stepped,
    typed,
)


@pytest.mark.parametrize("form", ["f4", "u1", "u2", "u4"])
def test_the_numbers_come_back(form: Form) -> None:
    packed = typed(np.array([0, 1, 200]), form)
    raw = base64.b64decode(packed["bdata"])
    assert np.frombuffer(raw, f"<{packed['dtype']}").tolist() == [0, 1, 200]


def test_coordinates_are_columns_to_a_hundredth() -> None:
    packed = coordinates(np.array([[1.2345, 2.0, 3.0], [4.0, np.nan, 6.0]]))
    x, y, z = (np.frombuffer(base64.b64decode(packed[k]["bdata"]), "<f4") for k in "xyz")
    np.testing.assert_allclose(x, [1.23, 4.0], rtol=1e-6)
    np.testing.assert_allclose(y, [2.0, np.nan])
    np.testing.assert_allclose(z, [3.0, 6.0])


def test_an_index_fits_its_form() -> None:
    assert index_form(65_536) == "u2"  # the last index is 65535
    assert index_form(65_537) == "u4"


def test_corners_are_columns() -> None:
    packed = corners(np.array([[0, 1, 2], [2, 1, 3]]))
    read = {k: np.frombuffer(base64.b64decode(packed[k]["bdata"]), "<u2").tolist() for k in "ijk"}
    assert read == {"i": [0, 2], "j": [1, 1], "k": [2, 3]}


@pytest.mark.parametrize("size", [1e-3, 150.0, 2e4])
def test_steps_are_within_half_a_step(size: float) -> None:
    values = np.random.default_rng(0).normal(size=(4, 3, 50)) * size
    packed = stepped(values)
    steps = np.frombuffer(base64.b64decode(packed["bdata"]), "<u2").astype(float)
    read = packed["origin"] + packed["step"] * steps
    assert packed["step"] == pytest.approx(np.ptp(values) / 65535)
    assert np.abs(read - values.ravel()).max() <= packed["step"] * 0.5001


def test_one_number_everywhere_needs_no_step() -> None:
    packed = stepped(np.full(3, 7.5))
    assert (packed["origin"], packed["step"]) == (7.5, 1.0)
