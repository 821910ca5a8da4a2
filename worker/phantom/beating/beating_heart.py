"""The analytic heart beating: every material point's path in closed form."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from jaxtyping import Float

from schemas.vocabulary import Structure
from worker.arrays import Faces, Points, Scalars
from worker.phantom.analytic_heart import Heart
from worker.phantom.beating.beat import Beat
from worker.phantom.beating.instant import Instant, instants
from worker.phantom.beating.motion import (
    Gradients,
    carried,
    carried_back,
    deformation_gradients,
)
from worker.phantom.beating.profile import Profile
from worker.phantom.beating.scaling import of_edv
from worker.phantom.pose import Pose
from worker.phantom.shape import HeartShape
from worker.surface_mesh import SurfaceMesh

_STEP_MM = 1e-4

Trajectories = Float[np.ndarray, "frames n 3"]
"""Positions of the same n points in every frame."""


@dataclass(frozen=True, eq=False)
class MovingSurface:
    """One mesh carried through time: vertices_mm (frames, n, 3), patient frame, and their faces."""

    vertices_mm: Trajectories
    faces: Faces

    def frame(self, index: int) -> SurfaceMesh:
        """The surface at one instant."""
        return SurfaceMesh(self.vertices_mm[index], self.faces)


@dataclass(frozen=True, eq=False)
class BeatingHeart:
    """The phantom over a whole beat, in the patient frame (LPS, mm).

    At end-diastole, time 0 and every `beat.cycle.duration_ms` after, it is `rest`: the shape's own
    shortenings, which are of the two-phase heart, play no part. Times are in ms, of any sign.
    Points of end-diastole are material points of the LV wall, of the surfaces and of their lids;
    in the LV cavity and beside the RV the motion is a continuation without a meaning.
    """

    shape: HeartShape = field(default_factory=HeartShape)
    beat: Beat = field(default_factory=Beat)
    pose: Pose = field(default_factory=Pose)

    def __post_init__(self) -> None:
        # What cannot be done is refused now: at end-systole the cavity is least.
        self.instants(np.array([self.beat.cycle.end_systole_ms]))

    @cached_property
    def rest(self) -> Heart:
        """The heart at end-diastole."""
        edv_ml = self.beat.edv_ml
        return Heart(self.shape if edv_ml is None else of_edv(self.shape, edv_ml), 0.0, self.pose)

    @cached_property
    def profile(self) -> Profile:
        """Its LV as radii by height."""
        return Profile(self.rest.layout, self.beat.infarct)

    def instants(self, times_ms: Scalars) -> list[Instant]:
        """The numbers of the motion at each time."""
        return instants(self.profile, self.beat, times_ms)

    def trajectories_mm(
        self, points_mm: Points, times_ms: Float[np.ndarray, " frames"]
    ) -> Trajectories:
        """Where points (n, 3) of end-diastole are at each of (frames,) times: (frames, n, 3)."""
        own = self.pose.to_heart(points_mm)
        return np.stack(
            [
                self.pose.to_patient(carried(self.profile, instant, own))
                for instant in self.instants(times_ms)
            ]
        )

    def at_rest_mm(self, points_mm: Points, time_ms: float) -> Points:
        """Where points (n, 3) of an instant are at end-diastole: the inverse of a trajectory."""
        own = self.pose.to_heart(points_mm)
        return self.pose.to_patient(carried_back(self.profile, self._instant(time_ms), own))

    def deformation_gradients(self, points_mm: Points, time_ms: float) -> Gradients:
        """F = dx/dX from end-diastole to the instant, patient frame, (n, 3, 3), at points (n, 3) of
        end-diastole. Its determinant is 1 in the LV wall; (F'F - 1) / 2 is the Green strain.
        """
        own = self.pose.to_heart(points_mm)
        turned = deformation_gradients(self.profile, self._instant(time_ms), own)
        rotation = self.pose.rotation
        return np.einsum("ij,njk,lk->nil", rotation, turned, rotation)

    def rest_normals(self, structure: Structure, points_mm: Points) -> Points:
        """Outward unit normals of a structure's surface at points (n, 3) of it, at end-diastole.

        By central differences of its formula, to 1e-6; at the sharp rims there is none.
        """
        slopes = np.column_stack(
            [
                self.rest.implicit_mm(structure, points_mm + step)
                - self.rest.implicit_mm(structure, points_mm - step)
                for step in _STEP_MM * np.eye(3)
            ]
        )
        return slopes / np.linalg.norm(slopes, axis=1, keepdims=True)

    def carried_areas(self, points_mm: Points, normals: Points, time_ms: float) -> Points:
        """What becomes of unit area at points of a surface (Nanson's formula): vectors (n, 3) along
        the surface's outward normal at the instant, as long as area now is to area before.

        points_mm, normals: (n, 3), of the surface at end-diastole; normals of length 1.
        """
        gradients = self.deformation_gradients(points_mm, time_ms)
        pulled = np.linalg.solve(np.swapaxes(gradients, 1, 2), normals[:, :, None])[:, :, 0]
        return np.linalg.det(gradients)[:, None] * pulled

    def implicit_mm(self, structure: Structure, points_mm: Points, time_ms: float) -> Scalars:
        """Negative inside a structure's surface at the instant, 0 on it: the signed length at
        end-diastole of where the points (n, 3) were. No distance but at end-diastole.
        """
        return self.rest.implicit_mm(structure, self.at_rest_mm(points_mm, time_ms))

    def surfaces(
        self, times_ms: Float[np.ndarray, " frames"], edge_mm: float = 1.0
    ) -> Mapping[Structure, MovingSurface]:
        """The true surfaces, meshed at end-diastole with about `edge_mm` and carried from there."""
        return {
            structure: MovingSurface(self.trajectories_mm(mesh.vertices_mm, times_ms), mesh.faces)
            for structure, mesh in self.rest.meshes(edge_mm).items()
        }

    def lv_volumes_ml(self, times_ms: Scalars) -> Mapping[Structure, Scalars]:
        """Exact volumes inside LV endo- and epicardium; the wall's is their difference."""
        parts = self.rest.layout
        edv_ml = parts.lv_inner.volume_below_ml(parts.base_mm)
        wall_ml = parts.lv_outer.volume_below_ml(parts.base_mm) - edv_ml
        stroke_ml = edv_ml * self.beat.ejection_fraction_percent / 100.0
        cavity_ml = edv_ml - stroke_ml * self.beat.cycle.contraction(times_ms)
        return {Structure.LV_ENDO: cavity_ml, Structure.LV_EPI: cavity_ml + wall_ml}

    def rv_shares(self, times_ms: Scalars) -> Scalars:
        """Exact volume of the RV cavity over its own at end-diastole."""
        return np.array([instant.rv_share for instant in self.instants(times_ms)])

    def _instant(self, time_ms: float) -> Instant:
        return self.instants(np.array([time_ms]))[0]
