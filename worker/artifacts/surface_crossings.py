"""Which surfaces of a frame pass through each other."""

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from schemas.vocabulary import Structure
from worker.evaluation.triangle_crossings import crossings
from worker.surface_mesh import SurfaceMesh


def crossing_triangles(
    surfaces: Mapping[Structure, SurfaceMesh],
) -> Mapping[Structure, Mapping[Structure, int]]:
    """For every surface, how many of its triangles pass through each other one."""
    counts: dict[Structure, dict[Structure, int]] = {structure: {} for structure in surfaces}
    for one, other in combinations(surfaces, 2):
        pairs = crossings(surfaces[one], surfaces[other])
        counts[one][other] = len(np.unique(pairs[:, 0]))
        counts[other][one] = len(np.unique(pairs[:, 1]))
    return counts
