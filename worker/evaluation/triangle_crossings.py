"""Where surfaces pass through themselves or each other, triangle by triangle.

Two triangles pass through each other when their insides meet and their planes differ. Then each
reaches to both sides of the other's plane, and the stretches of the planes' common line that they
cover overlap (Moeller, "A fast triangle-triangle intersection test", J. Graphics Tools 2, 1997).
This says the same as "an edge of one runs through the inside of the other", but leaves no gap where
edge meets edge.

Contact is not passing through. Triangles that only touch, with a corner or an edge, or that lie in
one plane do not count, nor does anything no deeper or no longer than TOUCHING_MM. So triangles that
share an edge never count, not even folded flat onto each other; those that share a corner count
where they meet elsewhere too; and positions decide, not indices: a copy of a mesh touches it
everywhere and crosses it nowhere. A triangle no thicker than TOUCHING_MM has no inside. A surface
that crosses another exactly along edges of its own that lie in the other's triangles is taken to
touch it.

All is reckoned from differences of nearby positions: surfaces may lie far from the origin.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from worker.arrays import Flags, Scalars
from worker.evaluation.box_pairs import (
    Pairs,
    SomeTriangles,
    Triangles,
    pairs_between,
    pairs_within,
)
from worker.surface_mesh import SurfaceMesh

TOUCHING_MM = 1e-6
"""Contact up to this depth or length is touching: a millionth of a millimetre, above the rounding
of double precision on a heart and far below that of a file in single precision."""

Heights = Float[np.ndarray, "k 3"]
"""Signed distances of a triangle's corners from a plane, mm."""

Directions = Float[np.ndarray, "k 3"]
"""A unit vector for each triangle or pair."""


def self_intersections(mesh: SurfaceMesh) -> Pairs:
    """Pairs of faces of one mesh that pass through each other: (k, 2), lower index first, sorted.

    Empty for a mesh that is fit for a simulation.
    """
    triangles = mesh.triangles_mm
    return _passing_through(triangles, triangles, pairs_within(triangles))


def crossings(one: SurfaceMesh, other: SurfaceMesh) -> Pairs:
    """Pairs (face of one, face of other) that pass through each other: (k, 2), sorted.

    Empty for surfaces that are apart, inside one another, or touch. Both in the same axes.
    """
    triangles, others = one.triangles_mm, other.triangles_mm
    return _passing_through(triangles, others, pairs_between(triangles, others))


def _passing_through(
    one_mm: SomeTriangles, other_mm: SomeTriangles, candidates: Iterator[Pairs]
) -> Pairs:
    """Those of the candidate pairs that pass through each other, sorted."""
    normals = _normals(one_mm)
    other_normals = normals if other_mm is one_mm else _normals(other_mm)
    planes, other_planes = _by_axes(one_mm, normals), _by_axes(other_mm, other_normals)
    found = [np.zeros((0, 2), dtype=np.int64)]
    for pairs in candidates:
        # Nearly all neighbours on a smooth surface drop out at the first plane.
        pairs = pairs[_straddle(other_planes, pairs[:, 1], planes, pairs[:, 0])]
        pairs = pairs[_straddle(planes, pairs[:, 0], other_planes, pairs[:, 1])]
        i, j = pairs.T
        found.append(pairs[_insides_meet(one_mm[i], other_mm[j], normals[i], other_normals[j])])
    every = np.concatenate(found)
    return every[np.lexsort((every[:, 1], every[:, 0]))]


def _normals(triangles_mm: Triangles) -> Float[np.ndarray, "m 3"]:
    """Unit normal of each triangle; zero for one too thin to have an inside."""
    edges = triangles_mm - np.roll(triangles_mm, 1, axis=1)
    across = np.cross(edges[:, 0], edges[:, 1])
    doubled_area = np.sqrt(np.einsum("mx,mx->m", across, across))[:, None]
    longest = np.sqrt(np.einsum("mcx,mcx->cm", edges, edges).max(axis=0))[:, None]
    # What rounding leaves of a thinner one's normal need not even stand on its edges.
    thick = doubled_area > TOUCHING_MM * longest
    return np.where(thick, across / np.where(thick, doubled_area, 1.0), 0.0)


@dataclass(frozen=True, eq=False)
class _ByAxes:
    """Triangles, one number of all of them beside the other in memory, for many to be asked.

    corners_mm: (3, 3, m), corner by axis. normals: (3, m), by axis.
    """

    corners_mm: Float[np.ndarray, "3 3 m"]
    normals: Float[np.ndarray, "3 m"]


def _by_axes(triangles_mm: SomeTriangles, normals: Float[np.ndarray, "_ 3"]) -> _ByAxes:
    corners = np.ascontiguousarray(np.moveaxis(triangles_mm, 0, 2))
    return _ByAxes(corners, np.ascontiguousarray(normals.T))


def _straddle(
    triangles: _ByAxes, i: Int[np.ndarray, " k"], planes: _ByAxes, j: Int[np.ndarray, " k"]
) -> Flags:
    """Whether triangles i reach to both sides of the planes of triangles j: more than touching."""
    normals = [axis.take(j) for axis in planes.normals]
    places_mm = [axis.take(j) for axis in planes.corners_mm[0]]
    above, below = np.zeros((2, len(i)), dtype=bool)
    for corner in triangles.corners_mm:
        height_mm = np.zeros(len(i))
        for axis, place_mm, normal in zip(corner, places_mm, normals, strict=True):
            offset = axis.take(i)
            offset -= place_mm
            offset *= normal
            height_mm += offset
        above |= height_mm > TOUCHING_MM
        below |= height_mm < -TOUCHING_MM
    return above & below


def _heights(
    corners_mm: Float[np.ndarray, "k 3 3"],
    plane_mm: Float[np.ndarray, "k 3 3"],
    normals: Directions,
) -> Heights:
    """How far each corner lies above a plane through the first corner of another triangle, mm."""
    return np.einsum("kcx,kx->kc", corners_mm - plane_mm[:, :1], normals)


def _insides_meet(
    one_mm: Float[np.ndarray, "k 3 3"],
    other_mm: Float[np.ndarray, "k 3 3"],
    normals: Directions,
    other_normals: Directions,
) -> Flags:
    """Whether two triangles that straddle each other's planes cover a common stretch of the line
    in which the planes meet.
    """
    line = np.cross(normals, other_normals)
    line /= np.linalg.norm(line, axis=1, keepdims=True)
    start, end = _stretch(_heights(one_mm, one_mm, line), _heights(one_mm, other_mm, other_normals))
    other_start, other_end = _stretch(
        _heights(other_mm, one_mm, line), _heights(other_mm, one_mm, normals)
    )
    common_mm = np.minimum(end, other_end) - np.maximum(start, other_start)
    return common_mm > TOUCHING_MM


def _stretch(along_mm: Heights, heights_mm: Heights) -> tuple[Scalars, Scalars]:
    """From where to where along a line a triangle meets it, mm.

    along_mm: corners' positions along the line. heights_mm: their distances from a plane through
    it, some above and some below.
    """
    # One corner is alone on its side; the two edges from it reach the line.
    one_above = (heights_mm > 0.0).sum(axis=1) == 1
    lone = np.where(one_above, heights_mm.argmax(axis=1), heights_mm.argmin(axis=1))
    order: Int[np.ndarray, "k 3"] = (lone[:, None] + np.arange(3)) % 3
    along = np.take_along_axis(along_mm, order, axis=1)
    height = np.take_along_axis(heights_mm, order, axis=1)
    fraction = height[:, :1] / (height[:, :1] - height[:, 1:])
    reached = along[:, :1] + fraction * (along[:, 1:] - along[:, :1])
    return reached.min(axis=1), reached.max(axis=1)
