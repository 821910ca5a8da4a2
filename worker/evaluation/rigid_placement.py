"""Laying a surface rigidly onto its reference, for measuring only: neither scaled nor mirrored."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation as Turn

from worker.arrays import Points, Rotation, Scalars, Vector
from worker.evaluation.area_centroid import area_centroid_mm
from worker.evaluation.nearest_off_rim import NearestOffRim
from worker.evaluation.surface_samples import area_uniform_samples_mm
from worker.observer import Cancelled, Observer, Unobserved
from worker.surface_mesh import SurfaceMesh

_SAMPLES = 4000
"""Points on either surface. Six numbers are sought; these are drawn alike in every run."""

_MOST_STEPS = 200

_STILL = 1e-6
"""A step that lessens the mean square distance by a smaller share than this is the last."""

_NO_STEP = 1e-9
"""In radians and radii of the surface: a step this small would only stir the rounding."""

_FIRST_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-3, 1e-6, 1e3
"""Of a step, beside a mean square of one: keeps turns that change nothing from being made."""

_ON_SURFACE_MM = 1e-7
"""Nearer than this the way to the nearest point has no direction but the normal's."""


@dataclass(frozen=True, eq=False)
class RigidPlacement:
    """The motion of points (3,) mm: `rotation @ point + offset_mm`; a rotation, never a mirror.

    translation_mm: (3,) of the surface's area centroid. The offset also has what the rotation
    about the origin of the frame moves.
    """

    rotation: Rotation
    offset_mm: Vector
    translation_mm: Vector

    @property
    def rotation_deg(self) -> float:
        """How far it turns, about whichever axis, 0 to 180."""
        return float(np.degrees(Turn.from_matrix(self.rotation).magnitude()))

    def moved(self, mesh: SurfaceMesh) -> SurfaceMesh:
        """The surface as it lies on its reference."""
        return SurfaceMesh(mesh.vertices_mm @ self.rotation.T + self.offset_mm, mesh.faces)

    def moved_back(self, mesh: SurfaceMesh) -> SurfaceMesh:
        """What lies where the surface was moved to, brought to where the surface was."""
        return SurfaceMesh((mesh.vertices_mm - self.offset_mm) @ self.rotation, mesh.faces)


def rigid_placement(
    mesh: SurfaceMesh, reference: SurfaceMesh, observer: Observer | None = None
) -> RigidPlacement:
    """The rigid motion of `mesh` that makes its mean square distance to `reference` least, both
    ways, exact from points spread over each to the triangles of the other; both in mm, with area.

    Gauss-Newton steps with damping (Levenberg-Marquardt) on the distances themselves, with new
    nearest points at each, from where the surface lies or with both centroids in one place,
    whichever is nearer: the nearest minimum, which is the right one for turns up to about 40
    degrees. Points whose nearest point is on an open surface's rim do not count: what only one of
    the two shows would draw it. Where a turn changes nothing, as of a ball, hardly any is made.

    Deterministic. Raises Cancelled when the observer says so.
    """
    watcher = observer or Unobserved()
    fit = _Fit(mesh, reference)
    together = area_centroid_mm(reference) - fit.centroid_mm
    here, elsewhere = (_Residuals(fit, np.eye(3), shift) for shift in (np.zeros(3), together))
    if elsewhere.lessened(here) > 0.0:
        here = elsewhere
    damping = _FIRST_DAMPING
    for _ in range(_MOST_STEPS):
        if watcher.is_cancelled():
            raise Cancelled
        step = here.step(damping)
        if np.linalg.norm(step) < _NO_STEP:
            break
        there = _Residuals(fit, *here.after(step))
        lessened = there.lessened(here)
        if lessened > 0.0:
            here, damping = there, max(damping / 10.0, _LEAST_DAMPING)
            if lessened < _STILL:
                break
        elif damping < _MOST_DAMPING:
            damping *= 10.0
        else:
            break
    moved = here.rotation @ fit.centroid_mm + here.offset_mm
    return RigidPlacement(here.rotation, here.offset_mm, moved - fit.centroid_mm)


class _Fit:
    """What stays the same from step to step."""

    def __init__(self, mesh: SurfaceMesh, reference: SurfaceMesh) -> None:
        generator = np.random.default_rng(0)
        self.centroid_mm = area_centroid_mm(mesh)
        self.on_mesh_mm = area_uniform_samples_mm(mesh, _SAMPLES, generator)
        self.on_reference_mm = area_uniform_samples_mm(reference, _SAMPLES, generator)
        self.of_mesh, self.of_reference = NearestOffRim(mesh), NearestOffRim(reference)
        apart = np.linalg.norm(self.on_mesh_mm - self.centroid_mm, axis=1)
        self.radius_mm = float(np.sqrt(np.mean(apart**2)))


class _Residuals:
    """Distances after a motion, and how they change with a further small one."""

    def __init__(self, fit: _Fit, rotation: Rotation, offset_mm: Vector) -> None:
        self.rotation, self.offset_mm = rotation, offset_mm
        self._radius_mm = fit.radius_mm
        self._middle_mm = rotation @ fit.centroid_mm + offset_mm
        own = fit.on_mesh_mm @ rotation.T + offset_mm
        places, facing, counts = fit.of_reference(own)
        # The reference is brought to the surface, whose boxes then serve for every motion.
        back = (fit.on_reference_mm - offset_mm) @ rotation
        feet, turned, also = fit.of_mesh(back)
        self._counts = np.concatenate([counts, also])
        if not self._counts.any():
            self._counts = ~self._counts
        self._moving_mm = np.concatenate([own, feet @ rotation.T + offset_mm])
        still = np.concatenate([places, fit.on_reference_mm])
        self._along, self._distances_mm = _directed(
            self._moving_mm - still, np.concatenate([facing, turned @ rotation.T])
        )

    def lessened(self, before: "_Residuals") -> float:
        """By which share the mean square distance is less than before, over what counts in both:
        a motion that makes more points count is no worse for it. 0 where it is not.
        """
        both = self._counts & before._counts
        now, then = (float(np.sum(one._distances_mm[both] ** 2)) for one in (self, before))
        return 1.0 - now / then if now < then else 0.0

    def step(self, damping: float) -> np.ndarray:
        """The turn about the middle and the shift that make distances least, (6,), both in
        radii of the surface.
        """
        counts = self._counts
        arms, along = (self._moving_mm[counts] - self._middle_mm) / self._radius_mm, self._along
        change = np.hstack([np.cross(arms, along[counts]), along[counts]])
        square = change.T @ change / len(change) + damping * np.eye(6)
        slope = change.T @ self._distances_mm[counts] / self._radius_mm / len(change)
        return -np.linalg.solve(square, slope)

    def after(self, step: np.ndarray) -> tuple[Rotation, Vector]:
        """The motion followed by a step: rotation (3, 3) and offset (3,) mm."""
        turn = Turn.from_rotvec(step[:3]).as_matrix()
        shift = self._middle_mm + self._radius_mm * step[3:]
        return turn @ self.rotation, turn @ (self.offset_mm - self._middle_mm) + shift


def _directed(ways_mm: Points, normals: Points) -> tuple[Points, Scalars]:
    """Unit directions in which distances grow, and the distances: along each way itself, which is
    not the normal's at an edge, but for points on the surface.
    """
    lengths = np.linalg.norm(ways_mm, axis=1)
    apart = lengths > _ON_SURFACE_MM
    along = np.where(apart[:, None], ways_mm / np.where(apart, lengths, 1.0)[:, None], normals)
    return along, np.where(apart, lengths, np.einsum("nd,nd->n", ways_mm, normals))
