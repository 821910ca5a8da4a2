"""A heart in closed form: ellipsoidal LV, crescent RV, flat base, contracting over one systole."""

from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
from jaxtyping import Int

from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Structure
from worker.arrays import Points, Scalars
from worker.phantom.bounds import require_within
from worker.phantom.contraction import Layout, layout
from worker.phantom.meshing import mesh_of_implicit
from worker.phantom.pose import Pose
from worker.phantom.rounding import rounded_intersection
from worker.phantom.shape import HeartShape
from worker.surface_mesh import SurfaceMesh

STRUCTURES = (Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO)
"""The surfaces that a phantom heart has."""

BACKGROUND, LV_CAVITY, LV_WALL, RV_CAVITY = 0, 1, 2, 3
"""Tissue indices of `Heart.contains`."""

Tissues = Int[np.ndarray, " n"]
"""One tissue index a point."""


@dataclass(frozen=True, eq=False)
class Heart:
    """One instant of the phantom, in the patient frame (LPS, mm).

    phase: 0 at end-diastole, 1 at end-systole. The LV wall's volume is the same at every phase.
    """

    shape: HeartShape = field(default_factory=HeartShape)
    phase: float = 0.0
    pose: Pose = field(default_factory=Pose)

    def __post_init__(self) -> None:
        require_within("phase", self.phase, 0.0, 1.0)

    @cached_property
    def layout(self) -> Layout:
        """The solids in the heart's own frame."""
        return layout(self.shape, self.phase)

    def implicit_mm(self, structure: Structure, points_mm: Points) -> Scalars:
        """Signed length to a structure's surface, negative inside; close to it, mm.

        points_mm: (n, 3), patient frame. Raises InputError for a structure the phantom lacks.
        """
        return self._own_implicit_mm(structure, self.pose.to_heart(points_mm))

    def contains(self, points_mm: Points) -> Tissues:
        """Tissue at each of (n, 3) points, patient frame: background 0, LV cavity 1, LV wall 2,
        RV cavity 3.
        """
        tissue = np.full(len(points_mm), BACKGROUND)
        tissue[self.implicit_mm(Structure.RV_ENDO, points_mm) < 0.0] = RV_CAVITY
        tissue[self.implicit_mm(Structure.LV_EPI, points_mm) < 0.0] = LV_WALL
        tissue[self.implicit_mm(Structure.LV_ENDO, points_mm) < 0.0] = LV_CAVITY
        return tissue

    def closed_form_volume_ml(self, structure: Structure) -> float | None:
        """Exact volume inside LV endo- or epicardium; None where there is no formula (the RV)."""
        solids = {
            Structure.LV_ENDO: self.layout.lv_inner,
            Structure.LV_EPI: self.layout.lv_outer,
        }
        solid = solids.get(structure)
        return solid.volume_below_ml(self.layout.base_mm) if solid else None

    def meshes(self, edge_mm: float = 1.0) -> dict[Structure, SurfaceMesh]:
        """True surfaces as closed meshes of about `edge_mm`, patient frame; exact to 0.001 mm."""
        require_within("edge_mm", edge_mm, 0.2, 5.0)
        return {structure: self._mesh(structure, edge_mm) for structure in STRUCTURES}

    def _mesh(self, structure: Structure, edge_mm: float) -> SurfaceMesh:
        parts = self.layout
        solid = {
            Structure.LV_ENDO: parts.lv_inner,
            Structure.LV_EPI: parts.lv_outer,
            Structure.RV_ENDO: parts.rv,
        }[structure]
        centre, reach = np.array(solid.centre_mm), np.array(solid.semi_axes_mm)
        upper = centre + reach
        upper[2] = parts.base_mm
        own = mesh_of_implicit(
            partial(self._own_implicit_mm, structure), centre - reach, upper, edge_mm
        )
        return SurfaceMesh(self.pose.to_patient(own.vertices_mm), own.faces)

    def _own_implicit_mm(self, structure: Structure, points_mm: Points) -> Scalars:
        """`implicit_mm` for points of the heart's own frame."""
        parts = self.layout
        if structure is Structure.LV_ENDO:
            solid = parts.lv_inner.signed_mm(points_mm)
        elif structure is Structure.LV_EPI:
            solid = parts.lv_outer.signed_mm(points_mm)
        elif structure is Structure.RV_ENDO:
            off_lv = self.shape.rv_gap_mm - parts.lv_outer.signed_mm(points_mm)
            solid = rounded_intersection(
                parts.rv.signed_mm(points_mm), off_lv, self.shape.rv_edge_radius_mm
            )
        else:
            raise InputError(
                ProblemType.UNSUPPORTED_SURFACE,
                f"The phantom has no {structure.value}; ask for lv_endo, lv_epi or rv_endo.",
            )
        below_base: Scalars = np.maximum(solid, points_mm[:, 2] - parts.base_mm)
        return below_base


def heart(phase: float = 0.0, shape: HeartShape | None = None) -> Heart:
    """The phantom heart at `phase` (0 end-diastole to 1 end-systole), lying obliquely as in a
    patient.
    """
    return Heart(shape or HeartShape(), phase)
