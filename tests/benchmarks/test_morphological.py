"""ITK's interpolation behind the same door as the other classical methods.

In a process of its own, as in the benchmark: beside the libraries that other tests have loaded,
ITK's end the interpreter with a segmentation fault, after the last test.
"""

from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

from schemas.problem import InputError
from schemas.vocabulary import Structure
from tests.worker.interpolation.stacks import STRUCTURE, cylinder, ellipsoid, heights_mm
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import component_count, is_outward
from worker.reconstruction.slice_stack import SliceStack
from worker.surface_mesh import SurfaceMesh

Morphological = Callable[[SliceStack, Structure], SurfaceMesh]


def interpolated(stack: SliceStack, structure: Structure) -> SurfaceMesh | str:
    """The surface, or why the stack was refused."""
    from benchmarks.morphological import morphological

    try:
        return morphological(stack, structure)
    except InputError as error:
        return error.detail


@pytest.fixture(scope="module")
def child() -> Iterator[ProcessPoolExecutor]:
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        yield pool


@pytest.fixture
def morphological(child: ProcessPoolExecutor) -> Morphological:
    def run(stack: SliceStack, structure: Structure) -> SurfaceMesh:
        surface = child.submit(interpolated, stack, structure).result(timeout=300)
        assert isinstance(surface, SurfaceMesh), surface
        return surface

    return run


def test_an_ellipsoid_comes_back(morphological: Morphological) -> None:
    truth = ellipsoid()
    mesh = morphological(truth.stack, STRUCTURE)
    assert is_outward(mesh)
    assert component_count(mesh) == 1
    between = mesh.vertices_mm[np.abs(heights_mm(mesh.vertices_mm)) <= 36.0]
    assert np.abs(truth.off_mm(between)).mean() <= 0.5
    assert volume_ml(mesh) == pytest.approx(truth.volume_ml, rel=0.02)


@pytest.mark.parametrize(
    ("absent", "ends"), [((), (-4.0, 36.0)), ((-3.0, 34.0), (-1.5, 33.0)), ((50.0,), (-4.0, 36.0))]
)
def test_a_cylinder_ends_where_its_slices_say(
    morphological: Morphological, absent: tuple[float, ...], ends: tuple[float, float]
) -> None:
    mesh = morphological(cylinder(absent=absent), STRUCTURE)
    heights = heights_mm(mesh.vertices_mm)
    assert (heights.min(), heights.max()) == pytest.approx(ends, abs=0.75)


def test_the_layers_are_where_the_slices_are(morphological: Morphological) -> None:
    """A voxel's offset would show as a drift: the radius is right to a tenth of a millimetre."""
    mesh = morphological(cylinder(spacing_mm=7.3), STRUCTURE)
    inner = mesh.vertices_mm[np.abs(heights_mm(mesh.vertices_mm) - 14.6) < 14.0]
    axis = cylinder().slices[0]
    across = np.linalg.norm(np.cross(inner - axis.origin_mm, axis.normal), axis=1)
    assert across.mean() == pytest.approx(20.0, abs=0.1)
    middle = (inner - axis.origin_mm).mean(axis=0)
    drift = middle - (middle @ axis.normal) * axis.normal
    assert np.linalg.norm(drift) <= 0.1


def test_a_slice_in_two_parts_keeps_the_largest(morphological: Morphological) -> None:
    mesh = morphological(cylinder(parts=2), STRUCTURE)
    assert component_count(mesh) == 1
    assert volume_ml(mesh) == pytest.approx(
        volume_ml(morphological(cylinder(), STRUCTURE)), rel=0.05
    )


def test_one_slice_is_refused_with_a_remedy(child: ProcessPoolExecutor) -> None:
    refusal = child.submit(interpolated, cylinder(count=1), STRUCTURE).result(timeout=300)
    assert isinstance(refusal, str)
    assert "outline it on two or more" in refusal
