"""What every interpolator owes: a closed outward surface, near the truth, where the patient is."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Structure, View
from tests.worker.interpolation.stacks import STRUCTURE, cylinder, ellipsoid, heights_mm
from worker.evaluation.distance import points_to_surface_mm
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import component_count, euler_number, is_outward
from worker.interpolation.hermite_rbf import hermite_rbf
from worker.interpolation.lofting import lofted
from worker.interpolation.shape_based import Blend, shape_based
from worker.reconstruction.slice_stack import SliceStack, StackSlice
from worker.surface_mesh import SurfaceMesh

Method = Callable[[SliceStack, Structure], SurfaceMesh]

METHODS: dict[str, Method] = {
    "shape-linear": partial(shape_based, blend=Blend.LINEAR, cell_mm=2.0),
    "shape-cubic": partial(shape_based, blend=Blend.CUBIC, cell_mm=2.0),
    "lofted": lofted,
    "hermite-rbf": partial(
        hermite_rbf, spacing_mm=4.0, cell_mm=2.0, solves=1, off_surface_mm=1.0, smoothing=0.0
    ),
    "hermite-rbf-refined": partial(hermite_rbf, spacing_mm=4.0, cell_mm=2.0),
}
every_method = pytest.mark.parametrize("name", METHODS)

# Linear blending flattens every bulge between slices.
MEAN_MM = {
    "shape-linear": 0.35,
    "shape-cubic": 0.15,
    "lofted": 0.10,
    "hermite-rbf": 0.10,
    "hermite-rbf-refined": 0.10,
}


@every_method
@pytest.mark.parametrize("long_axis", [True, False])
def test_an_ellipsoid_comes_back(name: str, long_axis: bool) -> None:
    truth = ellipsoid(long_axis=long_axis)
    mesh = METHODS[name](truth.stack, STRUCTURE)
    assert is_outward(mesh)
    assert euler_number(mesh) == 2
    assert component_count(mesh) == 1
    between = mesh.vertices_mm[np.abs(heights_mm(mesh.vertices_mm)) <= 36.0]
    off = np.abs(truth.off_mm(between))
    assert off.mean() <= MEAN_MM[name]
    assert off.max() <= 1.5
    assert volume_ml(mesh) == pytest.approx(truth.volume_ml, rel=0.02)


@every_method
def test_the_surface_passes_through_the_outlines(name: str) -> None:
    stack = ellipsoid(long_axis=False).stack
    away = points_to_surface_mm(stack.points_mm, METHODS[name](stack, STRUCTURE))
    assert away.mean() <= 0.1
    assert away.max() <= 1.0


@every_method
def test_a_cylinder_ends_half_a_gap_beyond_its_slices(name: str) -> None:
    mesh = METHODS[name](cylinder(), STRUCTURE)
    heights = heights_mm(mesh.vertices_mm)
    assert heights.min() == pytest.approx(-4.0, abs=1.5)
    assert heights.max() == pytest.approx(36.0, abs=1.5)
    shell = mesh.vertices_mm[(heights >= 0.0) & (heights <= 32.0)]
    across = np.linalg.norm(np.cross(shell - shell.mean(axis=0), _axis()), axis=1)
    # One solve takes the plain distance at the rim too, where the surface turns: it bulges there.
    assert np.abs(across - 20.0).max() <= (0.8 if name == "hermite-rbf" else 0.6)


@every_method
def test_it_ends_before_a_slice_where_it_is_absent(name: str) -> None:
    mesh = METHODS[name](cylinder(absent=(-3.0, 35.0)), STRUCTURE)
    heights = heights_mm(mesh.vertices_mm)
    assert is_outward(mesh)
    assert heights.min() >= -3.0
    assert heights.max() <= 35.0


@every_method
def test_a_slice_in_two_parts_keeps_the_surface_in_one_piece(name: str) -> None:
    mesh = METHODS[name](cylinder(parts=2), STRUCTURE)
    assert is_outward(mesh)
    assert component_count(mesh) == 1
    whole = volume_ml(METHODS[name](cylinder(), STRUCTURE))
    assert volume_ml(mesh) == pytest.approx(whole, rel=0.05)


@every_method
def test_slices_in_any_order_give_the_same_surface(name: str) -> None:
    stack = ellipsoid().stack
    forward = METHODS[name](stack, STRUCTURE)
    backward = METHODS[name](replace(stack, slices=stack.slices[::-1]), STRUCTURE)
    assert points_to_surface_mm(forward.vertices_mm, backward).max() <= 0.5


@every_method
def test_a_surface_moves_with_its_study(name: str) -> None:
    """Far from the origin nothing changes but the place."""
    stack = ellipsoid().stack
    there = np.array([400.0, -300.0, 900.0])
    moved = replace(stack, slices=tuple(_moved(s, there) for s in stack.slices))
    here = METHODS[name](stack, STRUCTURE)
    off = points_to_surface_mm(METHODS[name](moved, STRUCTURE).vertices_mm - there, here)
    assert off.max() <= 0.5


@every_method
def test_one_slice_is_refused_with_a_remedy(name: str) -> None:
    with pytest.raises(InputError, match="outline it on") as caught:
        METHODS[name](cylinder(count=1), STRUCTURE)
    assert caught.value.type is ProblemType.TOO_FEW_SLICES


@every_method
def test_a_structure_that_is_nowhere_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="rv_endo"):
        METHODS[name](cylinder(), Structure.RV_ENDO)


@every_method
def test_two_slices_are_enough(name: str) -> None:
    mesh = METHODS[name](cylinder(count=2), STRUCTURE)
    assert is_outward(mesh)
    assert volume_ml(mesh) == pytest.approx(np.pi * 20.0**2 * 16.0 / 1000.0, rel=0.2)


def test_long_axis_slices_are_used_by_the_rbf_alone() -> None:
    """Every second slice is gone: only what the long axis shows can replace it."""
    sparse = ellipsoid(spacing_mm=24.0)
    axial = replace(
        sparse.stack, slices=tuple(s for s in sparse.stack.slices if s.view is View.SAX)
    )
    for name, method in METHODS.items():
        both, alone = (method(s, STRUCTURE).vertices_mm for s in (sparse.stack, axial))
        if name.startswith("hermite-rbf"):
            assert np.abs(sparse.off_mm(both)).mean() < 0.5 * np.abs(sparse.off_mm(alone)).mean()
        else:
            np.testing.assert_array_equal(both, alone)


def _axis() -> np.ndarray:
    return cylinder().slices[0].normal


def _moved(slice_: StackSlice, by: np.ndarray) -> StackSlice:
    outlines = {
        structure: tuple(replace(o, points_mm=o.points_mm + by) for o in found)
        for structure, found in slice_.outlines.items()
    }
    return replace(slice_, origin_mm=slice_.origin_mm + by, outlines=outlines)
