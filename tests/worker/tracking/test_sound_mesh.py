"""What is carried has no fault to carry."""

import numpy as np

from tests.worker.tracking.ellipsoids import sphere
from worker.evaluation.topology import is_watertight
from worker.surface_mesh import SurfaceMesh
from worker.tracking.sound_mesh import sound_mesh
from worker.tracking.untangling import Untangler


def ball(radius_mm: float = 20.0) -> SurfaceMesh:
    vertices, faces = sphere()
    return SurfaceMesh(radius_mm * vertices / np.linalg.norm(vertices, axis=1)[:, None], faces)


def with_a_fin(mesh: SurfaceMesh, depth: int = 10, height_mm: float = 8.0) -> SurfaceMesh:
    """A face in three, one of these in three, and so on, the new vertices in and out by turns: what
    stands on so narrow a foot, no smoothing lays flat without needles.
    """
    vertices, faces = list(mesh.vertices_mm), mesh.faces.tolist()
    face = faces.pop(0)
    for step in range(depth):
        a, b, c = face
        middle = np.mean([vertices[k] for k in face], axis=0)
        outward = middle / np.linalg.norm(middle)
        vertices.append(middle + (-1) ** step * height_mm * outward)
        new = len(vertices) - 1
        faces += [[a, b, new], [b, c, new]]
        face = [c, a, new]
    faces.append(face)
    return SurfaceMesh(np.array(vertices), np.array(faces))


def test_a_sound_mesh_stays_as_it_is() -> None:
    mesh = ball()
    found = sound_mesh(mesh)
    np.testing.assert_array_equal(found.vertices_mm, mesh.vertices_mm)
    np.testing.assert_array_equal(found.faces, mesh.faces)


def test_a_fin_that_smoothing_does_not_lay_flat_is_drawn_together() -> None:
    mesh = with_a_fin(ball())
    assert is_watertight(mesh)
    assert Untangler(mesh).broken(mesh).any()
    found = sound_mesh(mesh)
    assert is_watertight(found)
    assert not Untangler(found).broken(found).any()
    assert len(found.faces) < len(mesh.faces)
