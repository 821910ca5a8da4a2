"""Hermite radial basis functions: one smooth field through all outlines, short and long axis.

Carr et al., "Reconstruction and representation of 3D objects with radial basis functions",
SIGGRAPH 2001: the field is 0 on the outlines and a distance on points beside them.
"""

import numpy as np

from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Structure
from worker.arrays import Points
from worker.interpolation.contour_samples import contour_samples
from worker.interpolation.disagreement import disagreement_mm
from worker.interpolation.far_points import far_points
from worker.interpolation.known_sides import known_sides
from worker.interpolation.level_surface import level_surface
from worker.interpolation.rbf_constraints import Constraints, beside_outlines
from worker.interpolation.stack_ends import beyond_ends
from worker.reconstruction.slice_stack import SliceStack
from worker.surface_mesh import SurfaceMesh

_FLATTEST = 0.01
"""Thickness over length below which all outlines lie in one plane."""
_FAR_MM = 15.0
_FAR_COUNT = 300
"""Of 8, 15 and 25 mm, 15 has the least error on aligned slices; 25 has less on displaced ones. The
count hardly matters between 150 and 600."""
_SIDES_PITCH_MM = 4.0
_SIDES_CLEAR_MM = 3.0
"""Nearer to an outline than this, the side of a place is the outline's own affair."""
_COMMITMENT = 0.5
"""A place on the wrong side is told this share of its in-plane distance, which is the most that its
true one can be."""
_SMOOTHING_PER_MM2 = 3000.0
"""Of 300 to 10 000, on hearts cut anew and displaced: more lowers the mean error a little yet,
and raises the largest from 10 to 13 mm."""


def hermite_rbf(
    stack: SliceStack,
    structure: Structure,
    *,
    spacing_mm: float = 2.0,
    off_surface_mm: float = 0.5,
    smoothing: float = 30.0,
    solves: int = 3,
    cell_mm: float = 1.25,
) -> SurfaceMesh:
    """The surface of `structure`, closed, outward, patient mm.

    Cubic functions (r^3) and a linear polynomial, one dense system for all points. spacing_mm:
    between points on the outlines. off_surface_mm: of the points beside them, along the outline's
    normal in its slice; nearer, or none, where the structure is narrow. Their value is that
    distance.

    solves: 1 or more; 1 is the method as published. Each further one, our refinement, multiplies
    these values by the cosine at which the surface leans from the slice, by the gradient of the
    solution before: in a slice that a surface leans from, the plain distance is too much, and
    contradicts what a crossing slice says there. Where the slices say inside and a solution
    outside, or the other way round, the next one is told. The first solve learns how the surface
    leans and two know it; a fourth changes 0.002 mm.

    smoothing: weight of smoothness against fidelity (`RBFInterpolator`, in mm^3). Points of
    short-axis slices get more of it, by the square of the distance at which other views' outlines
    miss theirs: each slice is a breath-hold and the long axis holds the stack, and a field through
    contradicting points shatters. Slices are taken where they are, not moved.

    Long-axis slices and slices without the structure say where it ends. Without a long axis the
    field closes by itself, or else about half a slice gap beyond the stack. An open outline ends
    likewise about its chord, which is no contour.
    cell_mm: edge of the lattice cells of marching cubes.
    Raises InputError for outlines that are all in one plane.
    """
    _require_depth(stack, structure)
    samples = contour_samples(stack, structure, spacing_mm, off_surface_mm)
    centre = samples.points_mm.mean(axis=0)
    missed = disagreement_mm(stack, structure)
    extra = _SMOOTHING_PER_MM2 * missed**2
    around = Constraints.exact(*far_points(samples.points_mm, _FAR_MM, _FAR_COUNT), smoothing)
    ends, past_them = beyond_ends(stack, structure)
    if solves == 1:
        # No later solve can be told where this one went wrong.
        around += Constraints.exact(ends, past_them, smoothing)
    sides, distances = known_sides(stack, structure, _SIDES_PITCH_MM)
    clear = np.abs(distances) > _SIDES_CLEAR_MM + 2.0 * missed
    sides = np.concatenate([sides[clear], ends])
    distances = np.concatenate([distances[clear], past_them])
    cosines = np.ones(len(samples.points_mm))
    for remaining in reversed(range(solves)):
        held = beside_outlines(samples, cosines, smoothing, extra) + around
        field = held.solved(centre)
        if remaining:
            cosines = samples.cosines(field)
            wrong = field(sides) * distances < 0.0
            around += Constraints.exact(sides[wrong], _COMMITMENT * distances[wrong], smoothing)
            sides, distances = sides[~wrong], distances[~wrong]
    return level_surface(
        lambda points: field(points)[:, None],
        held.points_mm.min(axis=0),
        held.points_mm.max(axis=0),
        cell_mm,
        samples.points_mm,
    )


def _require_depth(stack: SliceStack, structure: Structure) -> None:
    outlines = [o.points_mm for s in stack.slices for o in s.outlines.get(structure, ())]
    if len(outlines) and not _is_flat(np.concatenate(outlines)):
        return
    raise InputError(
        ProblemType.TOO_FEW_SLICES,
        f"The outlines of {structure.value} are not on two slices or more in different planes, so "
        "there is nothing to interpolate between; outline it on more slices, or on a long-axis "
        "view.",
    )


def _is_flat(points_mm: Points) -> bool:
    widths = np.linalg.svd(points_mm - points_mm.mean(axis=0), compute_uv=False)
    return bool(widths[2] < _FLATTEST * widths[0])
