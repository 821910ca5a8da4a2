"""What the files of every format are written from."""

import numpy as np
import pytest
import trimesh

from schemas.vocabulary import Axes
from worker.artifacts.measured import FIELDS
from worker.artifacts.mesh_files.content import Content
from worker.artifacts.mesh_files.vertex_field import vertex_field
from worker.surface_mesh import SurfaceMesh

JOB_ID = "0193b5c8a1f27d0e9c4b6a8d2e1f3057"


@pytest.fixture(scope="session")
def ellipsoid() -> SurfaceMesh:
    """Half axes 30, 20 and 10 mm round the point (100, -50, 25) mm."""
    sphere = trimesh.creation.icosphere(subdivisions=3)
    vertices_mm = sphere.vertices * [30.0, 20.0, 10.0] + [100.0, -50.0, 25.0]
    return SurfaceMesh(np.asarray(vertices_mm), np.asarray(sphere.faces, dtype=np.int64))


@pytest.fixture(scope="session")
def content(ellipsoid: SurfaceMesh) -> Content:
    """The ellipsoid, made by a job, with every field there is at its vertices."""
    count = len(ellipsoid.vertices_mm)
    random = np.random.default_rng(3)
    numbers = {name: random.normal(size=count) for name in FIELDS}
    numbers["third"] = random.integers(0, 3, count).astype(float)
    numbers["aha_segment"] = random.integers(0, 18, count).astype(float)
    fields = [vertex_field(name, values, count) for name, values in numbers.items()]
    return Content(ellipsoid, "ED_lv_endo", Axes.RAS, JOB_ID, fields)
