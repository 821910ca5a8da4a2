"""Partitions: surfaces nest and exclude as anatomy does."""

import pytest

from schemas.vocabulary import Structure
from worker.reconstruction.tissues import ENCLOSED, partition


def test_classes_are_as_many_as_surfaces_can_tell_apart() -> None:
    biventricular = partition([Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO])
    assert biventricular.class_count == 4
    assert partition([Structure.LV_ENDO]).class_count == 2
    assert partition(list(Structure)).class_count == 5


def test_order_of_surfaces_is_the_vocabularys_whatever_was_asked() -> None:
    asked = [Structure.RV_ENDO, Structure.LV_ENDO]
    assert partition(asked).surfaces == (Structure.LV_ENDO, Structure.RV_ENDO)
    assert partition(asked * 2).surfaces == (Structure.LV_ENDO, Structure.RV_ENDO)


def test_a_surface_inside_another_encloses_a_subset_of_its_classes() -> None:
    classes = partition(list(Structure))
    row = dict(zip(classes.surfaces, classes.encloses, strict=True))
    for inner in Structure:
        for outer in Structure:
            if ENCLOSED[inner] <= ENCLOSED[outer]:
                assert not (row[inner] & ~row[outer]).any()
            if not ENCLOSED[inner] & ENCLOSED[outer]:
                assert not (row[inner] & row[outer]).any()


def test_background_belongs_to_no_surface() -> None:
    for structure in Structure:
        assert not partition([structure]).encloses.all()


def test_no_surface_is_refused() -> None:
    with pytest.raises(ValueError, match="one surface at least"):
        partition([])
