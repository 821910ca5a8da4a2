import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from worker.evaluation import box_pairs
from worker.evaluation.box_pairs import pairs_between, pairs_within

# Whole numbers, many of them alike: boxes that touch, boxes without width, boxes of every size.
soups = st.integers(0, 8).flatmap(
    lambda count: arrays(np.float64, (count, 3, 3), elements=st.sampled_from([0, 1, 2, 5, 90]))
)


def sorted_pairs(blocks):
    return sorted(tuple(pair) for block in blocks for pair in block.tolist())


def every_pair(one, other):
    """All pairs of boxes that overlap, one comparison at a time."""
    return [
        (i, j)
        for i, first in enumerate(one)
        for j, second in enumerate(other)
        if (first.min(axis=0) <= second.max(axis=0)).all()
        and (second.min(axis=0) <= first.max(axis=0)).all()
    ]


@settings(deadline=None)
@given(soups, soups)
def test_all_overlapping_boxes_are_found_once(one, other):
    assert sorted_pairs(pairs_between(one, other)) == every_pair(one, other)


@settings(deadline=None)
@given(soups)
def test_within_a_set_each_pair_is_found_from_its_lower_index(soup):
    expected = [(i, j) for i, j in every_pair(soup, soup) if i < j]
    assert sorted_pairs(pairs_within(soup)) == expected


@pytest.mark.parametrize("offset_mm", [0.0, 700.0])
def test_boxes_of_all_sizes_over_several_blocks(monkeypatch, offset_mm):
    monkeypatch.setattr(box_pairs, "BLOCK", 7)
    random = np.random.default_rng(0)
    sizes = 10.0 ** random.uniform(-2.0, 1.5, (150, 1, 1))
    soup = random.uniform(0, 20, (150, 1, 3)) + sizes * random.normal(size=(150, 3, 3)) + offset_mm
    assert sorted_pairs(pairs_between(soup, soup)) == every_pair(soup, soup)


@pytest.mark.parametrize("at_once", [0, 2**25])
@pytest.mark.parametrize("offset_mm", [0.0, 700.0])
def test_within_a_set_crowded_or_not(monkeypatch, offset_mm, at_once):
    monkeypatch.setattr(box_pairs, "BLOCK", 7)
    monkeypatch.setattr(box_pairs, "AT_ONCE", at_once)
    random = np.random.default_rng(1)
    sizes = 10.0 ** random.uniform(-3.0, 1.5, (200, 1, 1))
    soup = random.uniform(0, 20, (200, 1, 3)) + sizes * random.normal(size=(200, 3, 3)) + offset_mm
    expected = [(i, j) for i, j in every_pair(soup, soup) if i < j]
    assert sorted_pairs(pairs_within(soup)) == expected


def test_a_crowd_is_looked_up_in_blocks(monkeypatch):
    monkeypatch.setattr(box_pairs, "BLOCK", 10)
    monkeypatch.setattr(box_pairs, "AT_ONCE", 500)
    alike = np.tile(np.eye(3), (65, 1, 1))
    blocks = list(pairs_within(alike))
    assert sum(map(len, blocks)) == 65 * 64 / 2
    assert max(map(len, blocks)) <= 10 * 65


def test_no_block_is_larger_than_promised(monkeypatch):
    monkeypatch.setattr(box_pairs, "BLOCK", 10)
    alike = np.tile(np.eye(3), (65, 1, 1))
    blocks = list(pairs_between(alike, alike[:40]))
    assert sum(map(len, blocks)) == 65 * 40
    assert max(map(len, blocks)) == 10 * 40
