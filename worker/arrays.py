"""Names of the arrays that travel between stages, with their axes."""

import numpy as np
from jaxtyping import Bool, Float, Int

Points = Float[np.ndarray, "n 3"]
"""Points in space; the variable's name says the frame (`points_mm`, `points_unit`)."""

SomePoints = Float[np.ndarray, "_ 3"]
"""Points where a function speaks of several sets, of different counts."""

PlanePoints = Float[np.ndarray, "n 2"]
"""Points in a slice's own two in-plane axes, mm."""

SomePlanePoints = Float[np.ndarray, "_ 2"]
"""The same where a function speaks of several sets, of different counts."""

PlanePoint = Float[np.ndarray, "2"]
"""One of them, or a direction there."""

Scalars = Float[np.ndarray, " n"]
"""One number a point."""

SomeScalars = Float[np.ndarray, "_"]
"""One number a point, where a function speaks of several sets, of different counts."""

Flags = Bool[np.ndarray, " n"]
"""One truth value a point."""

Vector = Float[np.ndarray, "3"]
"""One direction or position."""

Rotation = Float[np.ndarray, "3 3"]
"""An orthonormal matrix."""

Hessians = Float[np.ndarray, "n 3 3"]
"""Second derivatives at each of as many points."""

Faces = Int[np.ndarray, "m 3"]
"""Vertex indices of triangles, counter-clockwise seen from outside."""

SomeFaces = Int[np.ndarray, "_ 3"]
"""Faces where a function speaks of several meshes, of different counts."""
