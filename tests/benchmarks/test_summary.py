"""Ratios and their geometric mean."""

import math

import pytest

from benchmarks.methods import BY_NAME, OURS, RIVALS
from benchmarks.results import Results
from benchmarks.summary import geometric_mean, groups_of, ratios, taking_part


def test_geometric_mean_lets_halving_and_doubling_cancel() -> None:
    assert geometric_mean([0.5, 2.0]) == pytest.approx(1.0)
    assert geometric_mean([4.0]) == pytest.approx(4.0)
    assert geometric_mean([1.0, 10.0, 100.0]) == pytest.approx(10.0)
    assert math.isnan(geometric_mean([]))


def test_ratios_of_swapped_methods_are_inverse(results: Results) -> None:
    there, back = ratios(results, OURS, RIVALS[0]), ratios(results, RIVALS[0], OURS)
    assert [r.mean for r in there] == pytest.approx([0.5, 0.125])
    for one, other in zip(there, back, strict=True):
        assert one.mean * other.mean == pytest.approx(1.0)
        assert one.p95 * other.p95 == pytest.approx(1.0)
        assert one.maximum * other.maximum == pytest.approx(1.0)


def test_the_published_method_and_its_refinement_are_told_apart(results: Results) -> None:
    published, refined = (BY_NAME[name] for name in RIVALS)
    assert published.entry != refined.entry
    assert "our own" in refined.after
    assert "our own" not in published.after
    assert [r.mean for r in ratios(results, OURS, refined.name)] == pytest.approx([0.75, 0.25])


def test_a_failed_surface_has_no_ratio(results: Results) -> None:
    assert [r.case for r in ratios(results, OURS, "lofting")] == ["heart-shifted"]


def test_each_case_is_in_one_group(results: Results) -> None:
    found = [name for _, names in groups_of(results) for name in names]
    assert sorted(found) == sorted(case.name for case in results.cases)


def test_methods_come_in_the_order_of_the_tables(results: Results) -> None:
    names = [method.name for method in taking_part(results)]
    assert names == [
        "field-standard",
        "field-unaligned",
        "hermite-rbf",
        "hermite-rbf-refined",
        "lofting",
    ]
