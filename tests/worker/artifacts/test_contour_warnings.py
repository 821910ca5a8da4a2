"""Contradicting views are pointed out, steady ones are not."""

import pytest

from worker.artifacts.contour_warnings import contour_warnings


@pytest.mark.parametrize("noise_mm", [None, 0.0, 0.9])
def test_nothing_is_said_of_steady_contours(noise_mm: float | None) -> None:
    assert contour_warnings("ED", noise_mm) == []


def test_a_contradiction_is_told_with_its_size_and_its_frame() -> None:
    (sentence,) = contour_warnings("ES", 2.345)
    assert sentence.startswith("ES: ")
    assert "2.3 mm" in sentence
    assert "Check" in sentence
