"""The open base: where the valves are, and the surface cut open there.

The base plane of a surface goes through the valve points, the ends of open long-axis outlines,
when two slices have them; else it is the most basal short-axis plane that shows the surface.
"""

from dataclasses import dataclass

import numpy as np
import trimesh

from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Structure, View
from worker.arrays import Points, Vector
from worker.reconstruction.slice_stack import SliceStack, StackSlice
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True, eq=False)
class BasePlane:
    """A plane in mm, patient axes; `toward_base` is its unit normal and points out of the heart."""

    origin_mm: Vector
    toward_base: Vector


def find_base(stack: SliceStack, structure: Structure) -> BasePlane:
    """The base plane of a surface.

    Raises InputError when neither valve points nor short-axis slices show where the base is.
    """
    sax = [s for s in stack.slices if s.view is View.SAX and s.outlines]
    axis = _apex_to_base(sax, stack.points_mm)
    valve = [
        end
        for s in stack.slices
        for outline in s.outlines.get(structure, ())
        if not outline.closed
        for end in (outline.points_mm[0], outline.points_mm[-1])
    ]
    if len(valve) >= 4:
        return _through(np.array(valve), axis)
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
    """Unit vector along the short-axis normal, toward the wider outlines."""
    if not sax:
        centred = points_mm - points_mm.mean(axis=0)
        axis = np.linalg.eigh(centred.T @ centred)[1][:, 2]
        return axis if float(((centred @ axis) ** 3).sum()) <= 0.0 else -axis
    axis = sax[0].normal
    heights = np.array([s.origin_mm @ axis for s in sax])
    widths = np.array([_width(s) for s in sax])
    slope = float((heights - heights.mean()) @ (widths - widths.mean()))
    return axis if slope >= 0.0 else -axis


def _width(slice_: StackSlice) -> float:
    points = np.concatenate(
        [o.points_mm for outlines in slice_.outlines.values() for o in outlines]
    )
    return float(np.linalg.norm(points - points.mean(axis=0), axis=1).mean())


def _through(points_mm: Points, axis: Vector) -> BasePlane:
    centre = points_mm.mean(axis=0)
    normal = np.linalg.eigh((points_mm - centre).T @ (points_mm - centre))[1][:, 0]
    return BasePlane(centre, normal if normal @ axis > 0 else -normal)
