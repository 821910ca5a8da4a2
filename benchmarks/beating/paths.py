"""Where a tracked mesh says that material points go, beside where they really go."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from schemas.vocabulary import Structure
from worker.arrays import Points
from worker.evaluation.distance import nearest_on_surface
from worker.evaluation.surface_normals import unit
from worker.phantom.beating.beating_heart import BeatingHeart
from worker.surface_mesh import SurfaceMesh

Paths = Float[np.ndarray, "frames n 3"]
Lengths = Float[np.ndarray, "frames n"]


@dataclass(frozen=True, eq=False)
class TruePaths:
    """positions_mm, normals: (frames, n, 3) of n material points of a surface, and its outward
    normals there. area_ratio: (frames, n) of the surface about each, to end-diastole.
    """

    positions_mm: Paths
    normals: Paths
    area_ratio: Lengths


@dataclass(frozen=True, eq=False)
class PathErrors:
    """(frames, n), mm: along the true surface's normal, and within it. Both absolute."""

    normal_mm: Lengths
    tangential_mm: Lengths

    @property
    def length_mm(self) -> Lengths:
        return np.hypot(self.normal_mm, self.tangential_mm)


def true_paths(
    heart: BeatingHeart,
    structure: Structure,
    surface: SurfaceMesh,
    points_mm: Points,
    times_ms: Float[np.ndarray, " frames"],
) -> TruePaths:
    """Of the material points nearest to (n, 3) points of end-diastole, on the true `surface` there.

    Areas by Nanson's formula, from the deformation gradient: closed form, no mesh.
    """
    material_mm, _ = nearest_on_surface(points_mm, surface)
    normals = heart.rest_normals(structure, material_mm)
    carried = [heart.carried_areas(material_mm, normals, time) for time in times_ms.tolist()]
    return TruePaths(
        positions_mm=heart.trajectories_mm(material_mm, times_ms),
        normals=np.stack([unit(areas) for areas in carried]),
        area_ratio=np.stack([np.linalg.norm(areas, axis=1) for areas in carried]),
    )


def path_errors(found_mm: Paths, true_mm: Paths, normals: Paths) -> PathErrors:
    """Of places found, beside true ones with the unit normals there."""
    off_mm = found_mm - true_mm
    along = np.einsum("fnd,fnd->fn", off_mm, normals)
    within = off_mm - along[:, :, None] * normals
    return PathErrors(np.abs(along), np.linalg.norm(within, axis=2))
