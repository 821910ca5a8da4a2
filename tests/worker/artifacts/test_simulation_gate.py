"""A sound surface passes; every fault is named with its remedy, and nothing else is."""

from dataclasses import replace

import pytest

from schemas.vocabulary import Structure
from worker.artifacts.simulation_gate import SurfaceFaults, simulation_report

SOUND = SurfaceFaults(
    open_base=False,
    rims=0,
    manifold=True,
    components=1,
    euler_number=2,
    self_intersecting=0,
    crossing={Structure.LV_EPI: 0},
    sliver_percent=0.0,
    remeshed=True,
)


def test_a_sound_surface_is_fit() -> None:
    assert simulation_report(SOUND).model_dump() == {"fit": True, "reasons": []}


def test_an_open_base_is_one_rim() -> None:
    assert simulation_report(replace(SOUND, open_base=True, rims=1, euler_number=1)).fit
    assert not simulation_report(replace(SOUND, open_base=True)).fit
    assert not simulation_report(replace(SOUND, rims=1, euler_number=1)).fit


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ({"manifold": False}, "not manifold"),
        ({"rims": 2, "euler_number": 0}, "2 rims"),
        ({"components": 3, "euler_number": 6}, "3 pieces"),
        ({"euler_number": 0}, "1 handle;"),
        ({"euler_number": -2}, "2 handles;"),
        ({"self_intersecting": 1}, "1 triangle of it"),
        ({"crossing": {Structure.LV_EPI: 7}}, "7 triangles of it pass through lv_epi"),
        ({"sliver_percent": 12.34}, "12 % of its triangles"),
        ({"sliver_percent": 0.003, "remeshed": False}, "; set `target_edge_mm`"),
    ],
)
def test_each_fault_is_the_one_reason(fault: dict, words: str) -> None:
    found = simulation_report(replace(SOUND, **fault))
    assert not found.fit
    (reason,) = found.reasons
    assert words in reason


def test_all_faults_are_told_the_gravest_first() -> None:
    found = simulation_report(
        replace(SOUND, manifold=False, self_intersecting=4, sliver_percent=30.0)
    )
    assert ["manifold" in found.reasons[0], "pass through" in found.reasons[1]] == [True, True]
    assert "degrees" in found.reasons[2]
