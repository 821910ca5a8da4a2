"""A closed ventricle of two ellipsoids that beats, every material point's way known."""

from dataclasses import dataclass

import numpy as np
import trimesh

from worker.surface_mesh import SurfaceMesh

RADIUS_MM, LENGTH_MM, WALL_MM = 24.0, 42.0, 10.0
TURNED = trimesh.transformations.rotation_matrix(0.7, [1.0, 2.0, 3.0])[:3, :3]


@dataclass(frozen=True)
class Beat:
    """thinner, shorter: parts of the cavity's radius and length that it loses at end-systole.
    twist_deg: from apex to base. apex_mm: how far all of it moves along its axis.
    """

    thinner: float = 0.3
    shorter: float = 0.15
    twist_deg: float = 0.0
    apex_mm: float = 6.0

    def semi_axes_mm(self, phase: float, *, outer: bool) -> np.ndarray:
        """The wall's volume between the two ellipsoids stays the same."""
        radius = RADIUS_MM * (1.0 - self.thinner * phase)
        length = LENGTH_MM * (1.0 - self.shorter * phase)
        if outer:
            muscle = (RADIUS_MM + WALL_MM) ** 2 * (LENGTH_MM + WALL_MM) - RADIUS_MM**2 * LENGTH_MM
            length = length + WALL_MM
            radius = np.sqrt((muscle + radius**2 * (length - WALL_MM)) / length)
        return np.array([radius, radius, length])

    def at(self, on_sphere: np.ndarray, phase: float, *, outer: bool) -> np.ndarray:
        """Where material points, named by (n, 3) points of the unit sphere, are: mm."""
        points = on_sphere * self.semi_axes_mm(phase, outer=outer)
        angle = np.radians(self.twist_deg) * phase * on_sphere[:, 2] / 2.0
        turned = points.copy()
        turned[:, 0] = np.cos(angle) * points[:, 0] - np.sin(angle) * points[:, 1]
        turned[:, 1] = np.sin(angle) * points[:, 0] + np.cos(angle) * points[:, 1]
        turned[:, 2] += self.apex_mm * phase
        return turned


def phases(count: int) -> np.ndarray:
    """Of a whole cycle from end-diastole, (count,)."""
    return 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)


def sphere(fineness: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and outward faces of a unit sphere's even triangles."""
    made = trimesh.creation.icosphere(fineness)
    return np.array(made.vertices), np.array(made.faces, dtype=np.int64)


def own_surface(beat: Beat, phase: float, *, outer: bool) -> SurfaceMesh:
    """A frame's surface in a triangulation that shares nothing with the carried one."""
    vertices, faces = sphere()
    return SurfaceMesh(beat.at(vertices @ TURNED.T, phase, outer=outer), faces)
