"""Names of the arrays that travel between stages, with their axes. Coordinates are named by frame."""

import numpy as np
from jaxtyping import Bool, Float, Int

Points = Float[np.ndarray, "n 3"]
"""Points in space; the variable's name says the frame (`points_mm`, `points_unit`)."""

PlanePoints = Float[np.ndarray, "n 2"]
"""Points in a slice's own two in-plane axes, mm."""

Scalars = Float[np.ndarray, " n"]
"""One number a point."""

Flags = Bool[np.ndarray, " n"]
"""One truth value a point."""

Vector = Float[np.ndarray, "3"]
"""One direction or position."""

Rotation = Float[np.ndarray, "3 3"]
"""An orthonormal matrix."""

Faces = Int[np.ndarray, "m 3"]
"""Vertex indices of triangles, counter-clockwise seen from outside."""
