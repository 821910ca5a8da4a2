"""One frame's own surface, as what is carried onto it asks for it."""

from functools import cached_property

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from worker.arrays import Points, Scalars, SomePoints
from worker.evaluation.distance import nearest_on_surface
from worker.evaluation.surface_normals import unit, vertex_normals
from worker.surface_mesh import SurfaceMesh

_AGREE = 0.7
"""Cosine between two normals, below which a point's nearest one may be of the other side."""

_NORMAL_MM = 3.0
"""Length of a normal beside a position, when both together are to be near."""

_SLIDE_MM = 1.5
"""How far a match slides from a sample within its plane."""

Weights = Float[np.ndarray, "n 3"]
"""Of the corners of a triangle each, adding up to one."""


class FrameSurface:
    """A closed, outward mesh in mm, with its normals and trees. Raises InternalError for one
    without faces.
    """

    def __init__(self, mesh: SurfaceMesh) -> None:
        self.mesh = mesh
        self.normals = vertex_normals(mesh)

    @cached_property
    def _samples(self) -> "_Samples":
        """Only what is thin asks for them."""
        corners, at_corners = self.mesh.triangles_mm, self.normals[self.mesh.faces]
        middles = corners + np.roll(corners, -1, axis=1)
        at_middles = at_corners + np.roll(at_corners, -1, axis=1)
        places_mm = np.concatenate(
            [self.mesh.vertices_mm, corners.mean(axis=1), 0.5 * middles.reshape(-1, 3)]
        )
        normals = np.concatenate(
            [self.normals, unit(at_corners.sum(axis=1)), unit(at_middles.reshape(-1, 3))]
        )
        return _Samples(places_mm, normals)

    def nearest(self, points_mm: SomePoints) -> tuple[SomePoints, SomePoints]:
        """The nearest points of the surface, and its unit normals there."""
        places, faces = nearest_on_surface(points_mm, self.mesh)
        weights = corner_weights(places, self.mesh, faces)
        normals = np.einsum("nk,nkd->nd", weights, self.normals[self.mesh.faces[faces]])
        return places, unit(normals)

    def matched(self, points_mm: Points, normals: Points) -> tuple[Points, Points]:
        """Points of the surface that are near and face as `normals` do, and the normals there.

        Where the surface is thin, the nearest point of all may be of its other side.
        """
        places, found = self.nearest(points_mm)
        doubtful = np.flatnonzero(np.einsum("nd,nd->n", found, normals) < _AGREE)
        if len(doubtful):
            asked = points_mm[doubtful]
            around, across = self._samples.alike(asked, normals[doubtful])
            offset = asked - around
            along = offset - np.einsum("nd,nd->n", offset, across)[:, None] * across
            length = np.linalg.norm(along, axis=1, keepdims=True)
            slid = around + along * np.minimum(1.0, _SLIDE_MM / np.maximum(length, 1e-12))
            places, found = places.copy(), found.copy()
            places[doubtful], found[doubtful] = self.nearest(slid)
        return places, found


class _Samples:
    """Places of a surface, mm, and its unit normals there, (k, 3) each."""

    def __init__(self, places_mm: SomePoints, normals: SomePoints) -> None:
        self._places_mm, self._normals = places_mm, normals
        # Split in the middle, not at the median: built in a third of the time for few questions.
        self._tree = cKDTree(
            np.hstack([places_mm, _NORMAL_MM * normals]), balanced_tree=False, compact_nodes=False
        )

    def alike(self, points_mm: SomePoints, normals: SomePoints) -> tuple[SomePoints, SomePoints]:
        """Of each the place that is nearest in position and normal together, and its normal."""
        _, sample = self._tree.query(np.hstack([points_mm, _NORMAL_MM * normals]))
        return self._places_mm[sample], self._normals[sample]


def corner_weights(places_mm: Points, mesh: SurfaceMesh, faces: Int[np.ndarray, " n"]) -> Weights:
    """Barycentric weights of points that lie in the given faces; equal in one without area."""
    first, second_mm, third_mm = (mesh.vertices_mm[mesh.faces[faces, k]] for k in range(3))
    one, other, offset = second_mm - first, third_mm - first, places_mm - first
    aa, ab, bb = _dot(one, one), _dot(one, other), _dot(other, other)
    along_one, along_other = _dot(one, offset), _dot(other, offset)
    determinant = aa * bb - ab**2
    flat = determinant <= 1e-24
    safe = np.where(flat, 1.0, determinant)
    second = (bb * along_one - ab * along_other) / safe
    third = (aa * along_other - ab * along_one) / safe
    weights = np.stack([1.0 - second - third, second, third], axis=1)
    weights[flat] = 1.0 / 3.0
    clipped: Weights = np.clip(weights, 0.0, None)
    return clipped / clipped.sum(axis=1, keepdims=True)


def _dot(one: SomePoints, other: SomePoints) -> Scalars:
    found: Scalars = np.einsum("nd,nd->n", one, other)
    return found
