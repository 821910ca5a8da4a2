"""A field's zero level as one closed mesh."""

import numpy as np

from schemas.problem import InternalError, ProblemType
from worker.arrays import Points, Vector
from worker.reconstruction.component import outward, touched_component
from worker.reconstruction.isosurface import LogitsOf, isosurfaces
from worker.surface_mesh import SurfaceMesh


def level_surface(
    field: LogitsOf, lower: Vector, upper: Vector, cell_mm: float, touching: Points
) -> SurfaceMesh:
    """The component of the zero level of `field` (positive inside) that `touching` (n, 3) is on.

    lower, upper: (3,) corners of a box around it, mm; cell_mm: edge of the lattice cells.
    Raises InternalError when the field is nowhere positive.
    """
    (found,) = isosurfaces(field, lower, upper, cell_mm)
    if not len(found.faces):
        raise InternalError(
            ProblemType.NO_SURFACE,
            f"The interpolated field is nowhere inside on a lattice of {cell_mm:g} mm; "
            "use finer cells.",
        )
    vertices, faces = touched_component(found.vertices, found.faces, touching)
    return SurfaceMesh(np.ascontiguousarray(vertices), outward(vertices, faces))
