"""The surface of a solid given by a formula: marching cubes, then vertices pulled onto it."""

from collections.abc import Callable

import numpy as np
from skimage.measure import marching_cubes

from worker.arrays import Points, Scalars, Vector
from worker.surface_mesh import SurfaceMesh

_SLAB = 400_000  # points evaluated at once, to bound memory


def mesh_of_implicit(
    implicit_mm: Callable[[Points], Scalars], lower_mm: Vector, upper_mm: Vector, edge_mm: float
) -> SurfaceMesh:
    """Closed triangle mesh of {implicit = 0}, outward (the implicit is negative inside).

    implicit_mm: (n, 3) mm -> (n,) signed length. lower_mm, upper_mm: corners of a box; a flat top
    of the solid at upper_mm[2] is kept sharp. edge_mm: the grid's cell, about the longest edge.
    """
    # The top lies a twentieth of a cell above a layer of nodes: the rim is then cut off by no more
    # than that, where a plane at any other height loses up to a cell's corner.
    start = lower_mm - 2.0 * edge_mm
    rise = upper_mm[2] - 0.05 * edge_mm - start[2]
    start[2] += rise - np.ceil(rise / edge_mm) * edge_mm
    counts = np.ceil((upper_mm + 2.0 * edge_mm - start) / edge_mm).astype(int) + 1
    axes = [start[i] + edge_mm * np.arange(counts[i]) for i in range(3)]
    grid = np.empty(tuple(counts))
    slab = max(1, _SLAB // int(counts[1] * counts[2]))
    for first in range(0, int(counts[0]), slab):
        block = np.meshgrid(axes[0][first : first + slab], axes[1], axes[2], indexing="ij")
        points = np.stack(block, axis=-1).reshape(-1, 3)
        grid[first : first + slab] = implicit_mm(points).reshape(block[0].shape)
    # A node almost on the surface gives slivers; kept a tenth of a cell off, it does not, and the
    # projection puts the vertices right.
    near = np.abs(grid) < 0.1 * edge_mm
    grid[near] = np.where(grid[near] < 0.0, -0.1, 0.1) * edge_mm
    vertices, faces, _, _ = marching_cubes(grid, 0.0, gradient_direction="descent")
    vertices = start + edge_mm * vertices.astype(np.float64)
    return SurfaceMesh(_projected(implicit_mm, vertices, edge_mm), faces.astype(np.int64))


def _projected(
    implicit_mm: Callable[[Points], Scalars], points_mm: Points, edge_mm: float
) -> Points:
    """Newton steps along the gradient onto the zero set, none longer than half a cell."""
    step = 1e-4 * edge_mm
    for _ in range(3):
        gradient = np.column_stack(
            [
                (implicit_mm(points_mm + offset) - implicit_mm(points_mm - offset)) / (2.0 * step)
                for offset in step * np.eye(3)
            ]
        )
        steepness = np.maximum(np.sum(gradient**2, axis=1), 0.05)
        move = -(implicit_mm(points_mm) / steepness)[:, None] * gradient
        length = np.linalg.norm(move, axis=1, keepdims=True)
        points_mm = points_mm + move * np.minimum(1.0, 0.5 * edge_mm / np.maximum(length, 1e-12))
    return points_mm
