"""The open base: where the valves are, and the surface cut open there.

The base plane of a surface goes through the valve points, the ends of open long-axis outlines,
when two slices have them; else it is the most basal short-axis plane that shows the surface.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh

from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Structure, View
from worker.arrays import Points, SomePoints, Vector
from worker.reconstruction.slice_stack import SliceStack, StackSlice
from worker.surface_mesh import SurfaceMesh

_LEVEL_MM2 = 1e-6
"""Covariance of height and width below which short-axis slices show no taper."""


@dataclass(frozen=True, eq=False)
class BasePlane:
    """A plane in mm, patient axes; `toward_base` is its unit normal and points out of the heart."""

    origin_mm: Vector
    toward_base: Vector


def find_base(stack: SliceStack, structure: Structure) -> BasePlane:
    """The base plane of a surface.

    Raises InputError when neither valve points nor short-axis slices show where the base is.
    """
    arcs = [
        outline.points_mm
        for s in stack.slices
        for outline in s.outlines.get(structure, ())
        if not outline.closed
    ]
    if len(arcs) >= 2:
        return _through_ends(arcs)
    sax = [s for s in stack.slices if s.view is View.SAX and s.outlines]
    axis = _apex_to_base(sax, stack.points_mm)
    showing = [s for s in sax if structure in s.outlines]
    if not showing:
        raise InputError(
            ProblemType.UNSUPPORTED_SURFACE,
            f"An open base of {structure} needs open long-axis outlines on two slices or a "
            'short-axis slice that shows it; send one of them, or ask for "base": "closed".',
            pointer="/options/base",
        )
    top = max(showing, key=lambda s: float(s.origin_mm @ axis))
    normal = top.normal if top.normal @ axis > 0 else -top.normal
    return BasePlane(top.origin_mm, normal)


def cut_open(mesh: SurfaceMesh, base: BasePlane) -> SurfaceMesh:
    """The part of a closed mesh on the apical side of the base plane, open along it."""
    shape = trimesh.Trimesh(mesh.vertices_mm, mesh.faces, process=False)
    kept = trimesh.intersections.slice_mesh_plane(
        shape, plane_normal=-base.toward_base, plane_origin=base.origin_mm, cap=False
    )
    kept.merge_vertices()
    return SurfaceMesh(np.asarray(kept.vertices, float), np.asarray(kept.faces, np.int64))


def _apex_to_base(sax: list[StackSlice], points_mm: Points) -> Vector:
    """Unit vector along the short-axis normal, toward the wider outlines.

    A single short-axis slice says nothing of wider: then away from the thin end of all outlines.
    """
    centred = points_mm - points_mm.mean(axis=0)
    axis = sax[0].normal if sax else np.linalg.eigh(centred.T @ centred)[1][:, 2]
    heights = np.array([s.origin_mm @ axis for s in sax])
    widths = np.array([_width(s) for s in sax])
    slope = float(heights @ (widths - widths.mean())) if sax else 0.0
    if abs(slope) < _LEVEL_MM2:
        slope = -float(((centred @ axis) ** 3).sum())
    return axis if slope >= 0.0 else -axis


def _width(slice_: StackSlice) -> float:
    points = np.concatenate(
        [o.points_mm for outlines in slice_.outlines.values() for o in outlines]
    )
    return float(np.linalg.norm(points - points.mean(axis=0), axis=1).mean())


def _through_ends(arcs: Sequence[SomePoints]) -> BasePlane:
    """The plane through the ends of open outlines; the outlines themselves are apical of it."""
    ends = np.array([end for arc in arcs for end in (arc[0], arc[-1])])
    centre = ends.mean(axis=0)
    normal = np.linalg.eigh((ends - centre).T @ (ends - centre))[1][:, 0]
    apical = np.concatenate(arcs).mean(axis=0) - centre
    return BasePlane(centre, normal if normal @ apical < 0 else -normal)
