"""What tracking returns: one topology for all frames, and how far to trust it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from worker.arrays import Faces
from worker.evaluation.distance import DirectedDistance
from worker.surface_mesh import SurfaceMesh

NOT_OBSERVED = (
    "Contours show how a surface moves along its normal, not how its points slide within it or "
    "twist about the long axis. That part of the motion is the smoothest displacement that fits, "
    "and not an observation; area strain depends on it."
)
"""What goes with every tracked surface."""

Positions = Float[np.ndarray, "frames n 3"]
"""Vertices of one topology, frame by frame, mm."""


@dataclass(frozen=True)
class TrackedFrame:
    """One frame of a tracked surface, measured.

    to_surface, from_surface: exact distances from points spread over the tracked mesh to the
        frame's own surface, and back, mm.
    turned_over: triangles against the mesh's own normals at all their corners. against_surface:
        those against the frame's own surface at its nearest points; on an end thinner than the
        triangles that may be the other side. folded: those folded by over 150 degrees onto a
        neighbour. self_intersections: pairs of triangles that pass through each other.
    least_angle_deg: smallest angle of all triangles. area_ratio_min, area_ratio_max: of a
        triangle's area to that at the frame where it was made.
    step_mean_mm, step_max_mm: how far vertices moved from the frame before.
    """

    label: str
    to_surface: DirectedDistance
    from_surface: DirectedDistance
    turned_over: int
    against_surface: int
    folded: int
    self_intersections: int
    least_angle_deg: float
    below_20_deg_percent: float
    area_ratio_min: float
    area_ratio_max: float
    step_mean_mm: float
    step_max_mm: float


@dataclass(frozen=True, eq=False)
class TrackedSurface:
    """A surface over the cycle.

    vertices_mm: (frames, n, 3). faces: (m, 3), the same in all frames. rest: index of the frame
    whose mesh was carried. drift_mean_mm, drift_max_mm: how far from where they began vertices are
    when the mesh is carried on from the last frame onto the first surface again.
    """

    vertices_mm: Positions
    faces: Faces
    rest: int
    frames: tuple[TrackedFrame, ...]
    drift_mean_mm: float | None
    drift_max_mm: float | None
    not_observed: str = NOT_OBSERVED

    def mesh(self, frame: int) -> SurfaceMesh:
        """The mesh at a frame."""
        return SurfaceMesh(self.vertices_mm[frame], self.faces)
