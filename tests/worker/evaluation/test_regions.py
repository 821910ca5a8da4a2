"""Parts of a surface make up the whole."""

import numpy as np
import pytest

from schemas.vocabulary import Structure
from worker.evaluation.regions import regions
from worker.evaluation.surface_normals import vertex_normals
from worker.phantom.analytic_heart import heart

UP = np.array([0.0, 0.0, 1.0])
SURFACES = heart(0.0).meshes(2.5)


@pytest.mark.parametrize("structure", [s for s in SURFACES if s is not Structure.EPI])
def test_every_point_is_in_one_third_and_in_septum_or_free_wall(structure: Structure) -> None:
    mesh = SURFACES[structure]
    found = regions(structure, SURFACES, UP)
    assert found.not_split == {}
    inside = {
        name: part(mesh.vertices_mm, vertex_normals(mesh)) for name, part in found.parts.items()
    }
    for split in (("apex", "mid", "base"), ("septum", "free_wall")):
        assert (sum(inside[name].astype(int) for name in split) == 1).all()
        assert all(inside[name].any() for name in split)
    heights = {name: mesh.vertices_mm[part, 2] for name, part in inside.items()}
    assert heights["apex"].max() < heights["mid"].min() < heights["base"].min()


def test_beyond_its_ends_the_surface_goes_on() -> None:
    found = regions(Structure.LV_ENDO, SURFACES, UP).parts
    beyond, normals = np.outer([-500.0, 500.0], UP), np.zeros((2, 3))
    assert found["apex"](beyond, normals).tolist() == [True, False]
    assert found["base"](beyond, normals).tolist() == [False, True]


def test_without_an_axis_nothing_is_split_and_both_reasons_are_given() -> None:
    found = regions(Structure.LV_ENDO, SURFACES, None)
    assert found.parts == {}
    assert found.not_split.keys() == {"thirds", "septum"}


def test_without_the_other_ventricle_thirds_are_left() -> None:
    found = regions(Structure.LV_ENDO, {Structure.LV_ENDO: SURFACES[Structure.LV_ENDO]}, UP)
    assert found.parts.keys() == {"apex", "mid", "base"}
    assert "rv_endo" in found.not_split["septum"]
