"""What is judged on a patch is judged as on the whole mesh."""

import numpy as np
import pytest

from tests.worker.tracking.faulty import ball
from worker.evaluation.surface_normals import vertex_normals
from worker.surface_mesh import SurfaceMesh
from worker.tracking.faults import broken
from worker.tracking.patch import Patch


@pytest.fixture
def crumpled() -> SurfaceMesh:
    mesh = ball()
    noise = np.random.default_rng(0).normal(0.0, 0.6, mesh.vertices_mm.shape)
    return SurfaceMesh(mesh.vertices_mm + noise, mesh.faces)


def test_judged_triangles_are_found_broken_as_on_the_whole_mesh(crumpled: SurfaceMesh) -> None:
    whole = Patch.whole(crumpled)
    patch = whole.cut(whole.around(np.array([7]), 4))
    here = broken(patch.of(crumpled), patch.pairs)[patch.judged]
    there = broken(crumpled, whole.pairs)[patch.triangles[patch.judged]]
    np.testing.assert_array_equal(here, there)
    assert here.any()
    assert not here.all()
    assert 0 < patch.judged.sum() < len(patch.faces) < len(crumpled.faces) / 4


def test_free_vertices_have_the_neighbours_and_normals_of_the_whole_mesh(
    crumpled: SurfaceMesh,
) -> None:
    whole = Patch.whole(crumpled)
    patch = whole.cut(whole.around(np.array([7]), 4))
    numbers = patch.vertices[patch.free]
    np.testing.assert_array_equal(patch.degrees[patch.free], whole.degrees[numbers])
    np.testing.assert_allclose(
        vertex_normals(patch.of(crumpled))[patch.free], vertex_normals(crumpled)[numbers]
    )
    assert 0 < patch.free.sum() < len(patch.vertices)


def test_moving_free_vertices_changes_judged_triangles_alone(crumpled: SurfaceMesh) -> None:
    whole = Patch.whole(crumpled)
    patch = whole.cut(whole.around(np.array([7]), 4))
    part = patch.of(crumpled)
    moved = part.vertices_mm + np.where(patch.free[:, None], 1.0, 0.0)
    after = patch.put(crumpled, SurfaceMesh(moved, patch.faces))
    changed = (after.triangles_mm != crumpled.triangles_mm).any(axis=(1, 2))
    assert set(np.flatnonzero(changed)) <= set(patch.triangles[patch.judged])
    assert changed.any()


def test_rings_are_counted_by_edges() -> None:
    whole = Patch.whole(ball())
    start = np.array([7])
    assert np.flatnonzero(whole.around(start, 0)).tolist() == [7]
    assert whole.around(start, 1).sum() == 1 + whole.degrees[7]
    assert whole.around(start, len(whole.vertices)).all()


def test_a_part_put_back_unchanged_leaves_the_mesh(crumpled: SurfaceMesh) -> None:
    whole = Patch.whole(crumpled)
    patch = whole.cut(whole.around(np.array([7]), 2))
    back = patch.put(crumpled, patch.of(crumpled))
    np.testing.assert_array_equal(back.vertices_mm, crumpled.vertices_mm)
    own = crumpled.triangles_mm[patch.triangles]
    np.testing.assert_array_equal(patch.of(crumpled).triangles_mm, own)


def test_an_open_mesh_is_refused() -> None:
    mesh = ball()
    with pytest.raises(ValueError, match="not closed"):
        Patch.whole(SurfaceMesh(mesh.vertices_mm, mesh.faces[1:]))
