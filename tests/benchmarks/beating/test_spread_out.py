"""Frames of a short run."""

from benchmarks.beating.spread_out import spread_out


def test_all_frames_unless_fewer_are_wanted() -> None:
    assert spread_out(3, None) == spread_out(3, 3) == spread_out(3, 9) == [0, 1, 2]


def test_fewer_are_spread_evenly_from_the_first() -> None:
    assert spread_out(25, 5) == [0, 5, 10, 15, 20]
    assert spread_out(25, 4) == [0, 6, 12, 18]
