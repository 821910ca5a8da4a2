"""How much the surface about each vertex has grown or shrunk."""

import numpy as np
from jaxtyping import Float

from worker.evaluation.area_share import vertex_areas_mm2
from worker.tracking.tracked_surface import TrackedSurface


def area_strain(tracked: TrackedSurface, since: int | None = None) -> Float[np.ndarray, "frames n"]:
    """Area of the triangles about each vertex over that at frame `since`, less one. since: an
    index; the frame of the mesh where none is given.

    Its mean over a surface is observed. How it is spread depends on the tangential motion, which
    the regulariser alone decides (`NOT_OBSERVED`).
    """
    areas = np.stack([vertex_areas_mm2(tracked.mesh(i)) for i in range(len(tracked.vertices_mm))])
    return areas / areas[tracked.rest if since is None else since] - 1.0
