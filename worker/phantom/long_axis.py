"""The heart's own directions: from base to apex, and from left to right ventricle."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import trimesh

from schemas.vocabulary import Structure
from worker.arrays import Vector
from worker.evaluation.section import section
from worker.surface_mesh import SurfaceMesh

_BESIDE_MM = 1.0
"""Nearer to the axis than this a right ventricle gives no direction."""

_LV_FIRST = (Structure.LV_EPI, Structure.LV_ENDO, Structure.EPI, Structure.RV_EPI)


@dataclass(frozen=True, eq=False)
class LongAxis:
    """centre_mm: a point of the axis. towards_base, towards_rv: unit vectors, perpendicular."""

    centre_mm: Vector
    towards_base: Vector
    towards_rv: Vector


def long_axis(meshes: Mapping[Structure, SurfaceMesh], direction: Vector | None = None) -> LongAxis:
    """The long axis of closed surfaces: that of the LV, by its principal axis of inertia.

    direction: from apex to base, of any length; if unknown, the base is the blunter end.
    Without a right ventricle beside the left, `towards_rv` is some direction across the axis.
    """
    lv = next((meshes[s] for s in _LV_FIRST if s in meshes), next(iter(meshes.values())))
    solid = _solid(lv)
    centre = np.asarray(solid.center_mass)
    if direction is None:
        axis = np.asarray(solid.principal_inertia_vectors)[0]  # the least inertia comes first
        axis = axis * _blunter_end(lv, centre, axis)
    else:
        axis = direction
    axis = axis / np.linalg.norm(axis)
    rv = meshes.get(Structure.RV_ENDO) or meshes.get(Structure.RV_EPI)
    across = np.zeros(3) if rv is None else _across(axis, _solid(rv).center_mass - centre)
    if np.linalg.norm(across) < _BESIDE_MM:
        across = _across(axis, np.eye(3)[np.argmin(np.abs(axis))])
    return LongAxis(centre, axis, across / np.linalg.norm(across))


def _across(axis: Vector, direction: Vector) -> Vector:
    """The part of `direction` perpendicular to the unit vector `axis`."""
    part: Vector = direction - axis * (direction @ axis)
    return part


def _solid(mesh: SurfaceMesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices_mm, mesh.faces, process=False)


def _blunter_end(mesh: SurfaceMesh, centre_mm: Vector, axis: Vector) -> float:
    """+1 when the surface is wider near the end that `axis` points to, else -1."""
    along = (mesh.vertices_mm - centre_mm) @ axis
    low, high = along.min(), along.max()

    def width(fraction: float) -> float:
        at = centre_mm + axis * (low + fraction * (high - low))
        loops = section(mesh, at, axis)
        points = np.concatenate(loops) - at
        return float(np.linalg.norm(points - axis * (points @ axis)[:, None], axis=1).max())

    return 1.0 if width(0.9) >= width(0.1) else -1.0
