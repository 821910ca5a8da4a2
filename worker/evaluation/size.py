"""How much a surface holds and how large it is."""

import numpy as np

from schemas.problem import InternalError, ProblemType
from worker.surface_mesh import SurfaceMesh


def signed_volume_ml(mesh: SurfaceMesh) -> float:
    """Volume inside a closed mesh by the divergence theorem, in mL; negative if it faces inward.

    The sum over triangles of (p . q x r) / 6. Meaningless for an open mesh.
    """
    # From the middle of the mesh: far from the origin the sum would lose digits.
    corners = mesh.triangles_mm - mesh.vertices_mm.mean(axis=0)
    six_times = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return float(six_times / 6.0 / 1000.0)


def volume_ml(mesh: SurfaceMesh) -> float:
    """Volume inside a closed, outward mesh, in mL. Raises InternalError for one facing inward."""
    volume = signed_volume_ml(mesh)
    if volume < 0.0:
        raise InternalError(
            ProblemType.INTERNAL,
            f"The mesh faces inward (volume {volume:.3f} mL); reverse the order of its faces.",
        )
    return volume


def area_cm2(mesh: SurfaceMesh) -> float:
    """Area of all triangles, in cm2."""
    return float(triangle_areas_mm2(mesh).sum() / 100.0)


def triangle_areas_mm2(mesh: SurfaceMesh) -> np.ndarray:
    """Area of each triangle, (m,), mm2."""
    corners = mesh.triangles_mm
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas: np.ndarray = np.linalg.norm(doubled, axis=1) / 2.0
    return areas
