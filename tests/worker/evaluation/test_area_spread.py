import numpy as np
import pytest

from worker.evaluation.area_spread import area_spread


def test_even_areas_give_the_percentiles_of_the_points() -> None:
    values = np.random.default_rng(0).permutation(np.arange(1.0, 101.0))
    found = area_spread(np.full(100, 2.5), values)
    assert (found.mean, found.p5, found.p50, found.p95) == (50.5, 5.0, 50.0, 95.0)


def test_dense_points_weigh_no_more() -> None:
    """Cutting a point into pieces of its area, of the same value, changes nothing."""
    rng = np.random.default_rng(1)
    areas, values = rng.uniform(0.5, 2.0, 60), rng.normal(size=60)
    pieces = np.concatenate([np.repeat(areas[:20] / 4.0, 4), areas[20:]])
    cut = area_spread(pieces, np.concatenate([np.repeat(values[:20], 4), values[20:]]))
    whole = area_spread(areas, values)
    assert (cut.p5, cut.p50, cut.p95) == (whole.p5, whole.p50, whole.p95)
    assert cut.mean == pytest.approx(whole.mean)


def test_only_shares_of_the_area_count_and_points_without_any_do_not() -> None:
    rng = np.random.default_rng(2)
    areas, values = rng.uniform(0.5, 2.0, 60), rng.normal(size=60)
    more = area_spread(np.append(1000.0 * areas, 0.0), np.append(values, 1e9))
    found = area_spread(areas, values)
    assert (more.p5, more.p50, more.p95) == (found.p5, found.p50, found.p95)
    assert more.mean == pytest.approx(found.mean)


def test_it_follows_units_and_origin() -> None:
    rng = np.random.default_rng(3)
    areas, values = rng.uniform(0.5, 2.0, 60), rng.normal(size=60)
    found, moved = area_spread(areas, values), area_spread(areas, 3.0 * values - 7.0)
    for name in ("mean", "p5", "p50", "p95"):
        assert getattr(moved, name) == pytest.approx(3.0 * getattr(found, name) - 7.0)
