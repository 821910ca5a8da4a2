"""Whether a frame, by the options chosen for it, fits into the memory of a worker."""

import math

import numpy as np

from schemas.options import Options
from schemas.problem import InputError, ProblemType
from worker.reconstruction.hull import Hull

_MOST_NODES = 160_000_000
"""Lattice nodes times surfaces: some 3 GB."""

_MOST_SAMPLES = 8_000_000
"""Samples in the mix: some 2 GB."""


def check_workload(
    slices: int, hull: Hull, cell_mm: float, cell: float, surfaces: int, options: Options
) -> None:
    """Refuse a lattice or a mix of samples that would be killed for its memory.

    slices: of the frame. cell: edge of the finest lattice cells in unit lengths; cell_mm: in mm.
    surfaces: how many are reconstructed.
    Raises InputError TOO_LARGE, naming the option and a value that fits.
    """
    nodes = surfaces * float(np.prod((hull.upper - hull.lower) / cell + 1.0))
    if nodes > _MOST_NODES:
        fits_mm = math.ceil(100.0 * cell_mm * (nodes / _MOST_NODES) ** (1.0 / 3.0)) / 100.0
        raise InputError(
            ProblemType.TOO_LARGE,
            f"A lattice of {cell_mm:.3g} mm cells around this heart has {nodes:.2g} nodes, counted "
            f"for {surfaces} surfaces; at most {_MOST_NODES:.2g} fit into memory. Remedy: set "
            f"`mesh.grid_mm` to {fits_mm:g} or more, or request fewer surfaces a job.",
            pointer="/options/mesh/grid_mm",
        )
    sampling = options.sampling
    per_slice = sampling.uniform_samples_per_plane + 2 * sampling.contour_samples_per_plane
    level = slices * per_slice + sampling.hull_samples + sampling.far_samples
    samples = level * min(sampling.levels_in_mix, options.levels)
    if samples > _MOST_SAMPLES:
        raise InputError(
            ProblemType.TOO_LARGE,
            f"{slices} slices of {per_slice} samples, and so many levels in the mix, make "
            f"{samples:.2g} samples; at most {_MOST_SAMPLES:.2g} fit into memory. Remedy: lower "
            "`contour_samples_per_plane` and `uniform_samples_per_plane`.",
            pointer="/options/sampling",
        )
