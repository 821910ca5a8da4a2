"""A mesh of one frame brought onto the surface of another, as smoothly as that allows.

First the affine map A is found that brings the mesh X at its own frame nearest to the surface. Of
all positions x on the surface those are sought that differ most smoothly from it: u = x - XA has
the least Dirichlet energy, sum over edges of w |u_i - u_j|^2 with cotangent weights. A ventricle
that shortens and narrows as a whole costs nothing. Tangential motion, which leaves no trace on the
surface, is settled by this energy alone.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import igl
import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from worker.arrays import Points, Scalars, SomePoints
from worker.evaluation.distance import nearest_on_surface
from worker.evaluation.surface_normals import vertex_normals
from worker.surface_mesh import SurfaceMesh
from worker.tracking.affine_map import affine_copy
from worker.tracking.frame_surface import FrameSurface, corner_weights

_PULLS_PER_MM2 = (1e-3, 3e-3, 1e-2, 3e-2, 0.1)
"""Strength of the pull onto the surface, one after another: 1 / length^2 over which displacement is
smooth, 30 to 3 mm."""

_ROUNDS = 2
"""Matches at each strength."""

_CLOSE_PULL_PER_MM2 = 1.0
_CLOSE_ROUNDS = 3
"""Then the displacement that is missing is spread over a millimetre, no longer held against all."""

_FIRST_BACK_PER_MM2 = 3e-2
"""From this pull on the surface's own vertices draw the mesh too."""

_TRUSTED = 0.5
"""Cosine between the normals of two matched points from which on the match has its full weight."""

_LEAST_SHARE = 0.3
"""Of a triangle's corner: a point of the surface pulls a vertex that it hardly touches no more."""


@dataclass(frozen=True, eq=False)
class Carried:
    """Vertices (n, 3) at a frame, and the affine copy of the mesh at rest there, (n, 3), mm."""

    vertices_mm: Points
    copy_mm: Points


class Carrier:
    """The mesh at its own frame, with everything that is the same for all frames."""

    def __init__(self, rest: SurfaceMesh) -> None:
        vertices = np.ascontiguousarray(rest.vertices_mm)
        faces = np.ascontiguousarray(rest.faces)
        self.faces = rest.faces
        self._stiffness = stiffness = sparse.csc_matrix(-igl.cotmatrix(vertices, faces))
        areas = igl.massmatrix(vertices, faces, igl.MASSMATRIX_TYPE_BARYCENTRIC).diagonal()
        self._areas_mm2 = areas[:, None]
        self._rest = rest
        self._solvers: Mapping[float, SuperLU] = {
            pull: _factorised(stiffness + sparse.diags(pull * areas))
            for pull in (*_PULLS_PER_MM2, _CLOSE_PULL_PER_MM2)
        }

    def carried(self, before: Carried, surface: FrameSurface) -> Carried:
        """The mesh on or close to `surface`, from where it was before."""
        copy = affine_copy(self._rest, before.vertices_mm, surface)
        vertices = copy + (before.vertices_mm - before.copy_mm)
        held = self._stiffness @ copy
        for pull in _PULLS_PER_MM2:
            for _ in range(_ROUNDS):
                back = pull >= _FIRST_BACK_PER_MM2
                vertices = self._drawn(vertices, surface, held, pull, back=back)
        for done in range(_CLOSE_ROUNDS):
            held, back = self._stiffness @ vertices, done + 1 < _CLOSE_ROUNDS
            vertices = self._drawn(vertices, surface, held, _CLOSE_PULL_PER_MM2, back=back)
        return Carried(vertices, copy)

    def _drawn(
        self, vertices: Points, surface: FrameSurface, held: Points, pull: float, *, back: bool
    ) -> Points:
        """One solve. held: the stiffness times the positions that displacement is counted from."""
        wanted = vertices + self._offset(vertices, surface, back=back)
        drawn: Points = self._solvers[pull].solve(held + pull * self._areas_mm2 * wanted)
        return drawn

    def _offset(self, vertices: Points, surface: FrameSurface, *, back: bool) -> Points:
        """Where each vertex is drawn: to its match, and by points of the surface matched to it."""
        now = SurfaceMesh(vertices, self.faces)
        normals = vertex_normals(now)
        places, facing = surface.matched(vertices, normals)
        agreement = np.einsum("nd,nd->n", facing, normals)
        offset = np.clip(agreement / _TRUSTED, 0.0, 1.0)[:, None] * (places - vertices)
        if not back:
            return offset
        drawn, asked = _from_surface(now, normals, surface)
        # Both say how far the surface is along the normal; added up they would overshoot.
        along = np.einsum("nd,nd->n", offset, normals)
        twice = 0.5 * asked * (along + np.einsum("nd,nd->n", drawn, normals))
        return offset + drawn - twice[:, None] * normals


def _from_surface(
    now: SurfaceMesh, normals: Points, surface: FrameSurface
) -> tuple[Points, Scalars]:
    """How the surface's own vertices draw those of the mesh, so that it reaches into every end, and
    how much each vertex is drawn at all, 0 to 1.
    """
    target = surface.mesh.vertices_mm
    places, faces = nearest_on_surface(target, now)
    corners = now.faces[faces]
    facing = np.einsum("nkd,nd->n", normals[corners], surface.normals) > 0.0
    weights = corner_weights(places, now, faces) * facing[:, None]
    count = len(now.vertices_mm)
    shares = np.bincount(corners.ravel(), weights.ravel(), count)
    drawn: SomePoints = np.stack(
        [
            np.bincount(corners.ravel(), (weights * column[:, None]).ravel(), count)
            for column in (target - places).T
        ],
        axis=1,
    )
    return drawn / np.maximum(shares, _LEAST_SHARE)[:, None], np.minimum(shares / _LEAST_SHARE, 1.0)


def _factorised(matrix: sparse.spmatrix) -> SuperLU:
    """Symmetric and positive definite, so without pivots."""
    return splu(
        sparse.csc_matrix(matrix),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
