import numpy as np
import pytest

from schemas.vocabulary import Structure
from worker.artifacts.page.display_mesh import display_mesh, triangles_a_surface
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.topology import is_watertight
from worker.phantom.analytic_heart import heart
from worker.surface_mesh import SurfaceMesh


@pytest.fixture(scope="module")
def mesh() -> SurfaceMesh:
    return heart().meshes(2.0)[Structure.LV_ENDO]


def test_fields_stay_where_they_were(mesh: SurfaceMesh) -> None:
    thinned, fields = display_mesh(mesh, {"z": mesh.vertices_mm[:, 2]}, 2000)
    assert 1900 <= len(thinned.faces) <= 2000
    assert is_watertight(thinned)
    # The nearest vertex of before is within an edge.
    assert np.abs(fields["z"] - thinned.vertices_mm[:, 2]).max() < 2.0
    assert (
        np.abs(np.ptp(thinned.vertices_mm, axis=0) - np.ptp(mesh.vertices_mm, axis=0)).max() < 1.0
    )


def test_what_is_left_lies_on_the_surface(mesh: SurfaceMesh) -> None:
    thinned, _ = display_mesh(mesh, {}, 1000)
    assert surface_to_surface(thinned, mesh).hausdorff_mm < 0.2


def test_a_coarse_mesh_stays_as_it_is(mesh: SurfaceMesh) -> None:
    same, fields = display_mesh(mesh, {"z": mesh.vertices_mm[:, 2]}, len(mesh.faces))
    assert same is mesh
    assert fields["z"] is not None


def test_an_open_mesh_is_thinned_out_too(mesh: SurfaceMesh) -> None:
    opened = SurfaceMesh(mesh.vertices_mm, mesh.faces[: len(mesh.faces) // 2])
    thinned, _ = display_mesh(opened, {}, 1000)
    assert 500 < len(thinned.faces) <= 1000


def test_a_mesh_that_forks_is_thinned_out_too(mesh: SurfaceMesh) -> None:
    fork = np.concatenate([mesh.faces, [[*mesh.faces[0, :2], len(mesh.vertices_mm) - 1]]])
    forked = SurfaceMesh(mesh.vertices_mm, fork)
    thinned, _ = display_mesh(forked, {}, 1000)
    assert 900 <= len(thinned.faces) <= 1000


def test_a_page_of_many_frames_does_not_grow_with_each_as_much() -> None:
    assert triangles_a_surface(0) == triangles_a_surface(1) == triangles_a_surface(4) == 7000
    assert triangles_a_surface(8) == 3500
    assert triangles_a_surface(1000) == 2000
