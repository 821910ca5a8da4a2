import pytest

from jobs.durations import BOUNDS_S, Durations, bucket


def test_bounds_grow() -> None:
    assert list(BOUNDS_S) == sorted(set(BOUNDS_S))


@pytest.mark.parametrize(
    ("seconds", "place"), [(0.0, 0), (0.1, 0), (0.11, 1), (3600.0, len(BOUNDS_S) - 1)]
)
def test_a_bound_belongs_to_its_bucket(seconds: float, place: int) -> None:
    assert bucket(seconds) == place


def test_what_is_beyond_every_bound_is_counted() -> None:
    assert bucket(1e6) == len(BOUNDS_S)
    counted = Durations({0: 2, bucket(1e6): 1}, 1e6).cumulative()
    assert counted[0] == ("0.1", 2)
    assert counted[-2:] == [("3600", 2), ("+Inf", 3)]
