import numpy as np
import pytest
import trimesh

from worker.surface_mesh import SurfaceMesh


def as_mesh(solid: trimesh.Trimesh) -> SurfaceMesh:
    return SurfaceMesh(
        np.asarray(solid.vertices, dtype=np.float64), np.asarray(solid.faces, dtype=np.int64)
    )


@pytest.fixture(scope="session")
def sphere():
    """Sphere of 20 mm radius, its vertices exactly on it, 20 480 faces."""
    return as_mesh(trimesh.creation.icosphere(subdivisions=5, radius=20.0))


@pytest.fixture(scope="session")
def torus():
    return as_mesh(trimesh.creation.torus(20.0, 5.0))


@pytest.fixture
def cube():
    return as_mesh(trimesh.creation.box((10.0, 10.0, 10.0)))


@pytest.fixture(scope="session")
def spheres():
    """Spheres of a radius in mm, at a number of subdivisions."""

    def make(radius_mm: float, subdivisions: int = 5) -> SurfaceMesh:
        return as_mesh(trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius_mm))

    return make
