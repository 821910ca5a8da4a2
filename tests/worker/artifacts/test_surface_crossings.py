"""Surfaces that pass through each other are counted on both sides."""

import numpy as np
import trimesh

from schemas.vocabulary import Structure
from worker.artifacts.surface_crossings import crossing_triangles
from worker.surface_mesh import SurfaceMesh


def ball(radius_mm: float, x_mm: float = 0.0) -> SurfaceMesh:
    solid = trimesh.creation.icosphere(subdivisions=4, radius=radius_mm)
    return SurfaceMesh(
        np.asarray(solid.vertices) + np.array([x_mm, 0.0, 0.0]),
        np.asarray(solid.faces, dtype=np.int64),
    )


def test_nested_and_separate_surfaces_do_not_cross() -> None:
    endo, epi, rv = Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO
    found = crossing_triangles({endo: ball(20.0), epi: ball(30.0), rv: ball(10.0, 45.0)})
    assert found == {endo: {epi: 0, rv: 0}, epi: {endo: 0, rv: 0}, rv: {endo: 0, epi: 0}}


def test_a_surface_through_another_is_counted_on_both() -> None:
    endo, epi = Structure.LV_ENDO, Structure.LV_EPI
    found = crossing_triangles({endo: ball(20.0, 5.0), epi: ball(22.0)})
    assert found[endo][epi] > 20
    assert found[epi][endo] > 20


def test_one_surface_crosses_none() -> None:
    assert crossing_triangles({Structure.EPI: ball(20.0)}) == {Structure.EPI: {}}
