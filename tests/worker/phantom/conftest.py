import numpy as np
import pytest
import trimesh

from worker.phantom import heart
from worker.surface_mesh import SurfaceMesh


def as_mesh(solid: trimesh.Trimesh) -> SurfaceMesh:
    return SurfaceMesh(
        np.asarray(solid.vertices, dtype=np.float64), np.asarray(solid.faces, dtype=np.int64)
    )


@pytest.fixture(scope="session")
def diastole():
    """True surfaces at end-diastole, 2 mm edges."""
    return heart(0.0).meshes(2.0)


@pytest.fixture(scope="session")
def systole():
    return heart(1.0).meshes(2.0)


@pytest.fixture(scope="session")
def cube():
    """A cube of 10 mm about the origin."""
    return as_mesh(trimesh.creation.box((10.0, 10.0, 10.0)))


@pytest.fixture(scope="session")
def sphere():
    """A sphere of 20 mm radius about the origin."""
    return as_mesh(trimesh.creation.icosphere(subdivisions=5, radius=20.0))


@pytest.fixture(scope="session")
def torus():
    """A torus about z: radius 20 mm of the ring, 5 mm of the tube."""
    return as_mesh(trimesh.creation.torus(20.0, 5.0, major_sections=96, minor_sections=96))
