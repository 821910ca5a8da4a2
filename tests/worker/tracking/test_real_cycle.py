"""A real left ventricle's cycle, as a model fitted it to every frame."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from worker.evaluation.distance import nearest_on_surface
from worker.observer import Unobserved
from worker.remeshing.remeshing import remesh
from worker.surface_mesh import SurfaceMesh
from worker.tracking.tracking import track

FITTED = (
    Path(__file__).resolve().parents[4]
    / "shared/data/bivme_guide_points/fitted_surfaces_patient1.npz"
)
CAVITY = ("LV_ENDOCARDIAL", "AORTA_VALVE", "MITRAL_VALVE")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not FITTED.is_file(), reason="no fitted cycle beside the checkout"),
]


def cavities() -> list[SurfaceMesh]:
    with np.load(FITTED) as fitted:
        faces = fitted["faces"][np.isin(fitted["materials"], CAVITY)]
        every = fitted["vertices"].astype(np.float64)
    cavity = trimesh.Trimesh(every[0], faces, process=False)
    trimesh.repair.fix_normals(cavity)
    used, renamed = np.unique(np.array(cavity.faces), return_inverse=True)
    renamed = renamed.reshape(-1, 3).astype(np.int64)
    return [SurfaceMesh(vertices[used], renamed) for vertices in every]


def test_a_real_cavity_is_followed_over_leaps_of_four_frames_without_a_fold() -> None:
    surfaces = cavities()[::4]
    first = surfaces[0]
    even = remesh(
        first.vertices_mm,
        first.faces,
        2.5,
        lambda points_mm: nearest_on_surface(points_mm, first)[0],
        Unobserved(),
    )
    found = track(SurfaceMesh(*even), [(str(i), mesh) for i, mesh in enumerate(surfaces)], 0)
    for frame in found.frames:
        assert frame.to_surface.mean_mm < 0.1
        assert frame.from_surface.mean_mm < 0.2
        assert (frame.turned_over, frame.against_surface, frame.folded) == (0, 0, 0)
        assert frame.self_intersections == 0
    assert found.drift_mean_mm < 0.3
