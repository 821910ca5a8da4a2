from itertools import pairwise

import numpy as np
import pytest

from worker.artifacts.page.colour_scales import (
    AMOUNT,
    ERROR,
    SIGNED,
    robust_range,
    scale_of_amounts,
    scale_of_kinds,
    segment_colours,
)


def test_outliers_and_gaps_do_not_stretch_a_range() -> None:
    values = np.concatenate([np.linspace(10.0, 20.0, 101), [1e6, np.nan]])
    low, high = robust_range(values, kind=AMOUNT)
    assert 10.0 < low < 11.0
    assert 19.0 < high < 20.1
    assert robust_range(values, kind=ERROR)[0] == 0.0
    low, high = robust_range(np.linspace(-1.0, 3.0, 101), kind=SIGNED)
    assert -low == high == pytest.approx(2.8)


@pytest.mark.parametrize("values", [[], [np.nan], [3.0, 3.0], [0.0]])
@pytest.mark.parametrize("kind", [ERROR, AMOUNT, SIGNED])
def test_there_is_always_a_range(values: list[float], kind: tuple[str, ...]) -> None:
    low, high = robust_range(np.array(values), kind=kind)
    assert low < high


@pytest.mark.parametrize("gaps", [True, False])
def test_grey_is_below_the_range_and_nowhere_else(gaps: bool) -> None:
    axis, nothing = scale_of_amounts(2.0, 10.0, ERROR, gaps=gaps)
    scale = axis["colorscale"]
    assert [scale[0][0], scale[-1][0]] == [0.0, 1.0]
    assert all(a[0] <= b[0] for a, b in pairwise(scale))
    assert axis["cmin"] == nothing
    assert (nothing < 2.0) == gaps
    # Where the range begins, its first colour begins.
    share = (2.0 - axis["cmin"]) / (axis["cmax"] - axis["cmin"])
    assert share == pytest.approx(next(at for at, colour in scale if colour == ERROR[0]))
    ticks = axis["colorbar"]["tickvals"]
    assert ticks == [2.0, 4.0, 6.0, 8.0, 10.0]


@pytest.mark.parametrize("high", [1e-6, 0.0037, 1.0, 9.99, 12345.0])
def test_ticks_are_few_and_round(high: float) -> None:
    axis, _ = scale_of_amounts(0.0, high, ERROR, gaps=False)
    ticks = axis["colorbar"]["tickvals"]
    assert 2 <= len(ticks) <= 7
    assert ticks[0] == 0.0
    assert ticks[-1] <= high * (1.0 + 1e-9)


def test_kinds_have_flat_colours_of_their_own() -> None:
    axis = scale_of_kinds(("a", "b"), ("#000000", "#ffffff"))
    assert axis["colorscale"] == [
        [0.0, "#000000"],
        [0.5, "#000000"],
        [0.5, "#ffffff"],
        [1.0, "#ffffff"],
    ]
    assert (axis["cmin"], axis["cmax"]) == (-0.5, 1.5)


def test_all_segments_can_be_told_apart() -> None:
    colours = segment_colours()
    assert len(colours) == len(set(colours)) == 18
