"""Even triangles, and the surface as closed as before."""

import numpy as np
import pytest

from schemas.problem import InternalError
from worker.evaluation.topology import euler_number, is_watertight
from worker.reconstruction import remeshing
from worker.reconstruction.isosurface import isosurfaces
from worker.reconstruction.remeshing import remesh
from worker.surface_mesh import SurfaceMesh


@pytest.fixture(scope="module")
def thin() -> SurfaceMesh:
    """A lens 40 mm across and 8 mm thick."""

    def lens(points: np.ndarray) -> np.ndarray:
        return (1.0 - np.linalg.norm(points / [20.0, 20.0, 4.0], axis=1))[:, None]

    (found,) = isosurfaces(lens, np.full(3, -23.0), np.full(3, 23.0), 1.0)
    return SurfaceMesh(found.vertices, found.faces)


@pytest.mark.parametrize("edge_mm", [1.5, 2.0, 2.5, 3.0, 4.0, 5.0])
def test_it_stays_closed_at_every_edge_length(thin: SurfaceMesh, edge_mm: float) -> None:
    even = SurfaceMesh(*remesh(thin.vertices_mm, thin.faces, edge_mm))
    assert is_watertight(even)
    assert euler_number(even) == euler_number(thin)


def test_an_attempt_that_is_not_closed_is_followed_by_another(
    thin: SurfaceMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    clustered, asked = remeshing._clustered, []

    def first_with_a_hole(
        vertices, cells, subdivisions: int, target: int
    ) -> tuple[np.ndarray, np.ndarray]:
        asked.append(target)
        even_vertices, even_faces = clustered(vertices, cells, subdivisions, target)
        return even_vertices, even_faces[1:] if len(asked) == 1 else even_faces

    monkeypatch.setattr(remeshing, "_clustered", first_with_a_hole)
    assert is_watertight(SurfaceMesh(*remesh(thin.vertices_mm, thin.faces, 4.0)))
    assert len(asked) >= 2
    assert asked[1] < asked[0]


def test_what_is_never_closed_is_no_result(thin: SurfaceMesh) -> None:
    with pytest.raises(InternalError, match="another `target_edge_mm`"):
        remesh(thin.vertices_mm, thin.faces[1:], 4.0)
