"""How a level set bends, from the derivatives of its field: no triangle comes into it.

Goldman, "Curvature formulas for implicit curves and surfaces" (2005), equations 4.1 and 4.2.
"""

import numpy as np

from worker.arrays import Hessians, Points, Scalars


def level_set_curvature(gradients: Points, hessians: Hessians) -> tuple[Scalars, Scalars]:
    """Gaussian curvature (n,) and mean curvature (n,) of the level sets through n points.

    gradients: (n, 3), not zero, of a field that grows inward. hessians: (n, 3, 3). Per length
    unit squared and per length unit of theirs; the mean is that of the principal curvatures,
    positive where the surface is convex seen from outside: 1/r on a sphere of radius r.
    """
    steepness = np.linalg.norm(gradients, axis=1)
    along = np.einsum("na,nab,nb->n", gradients, hessians, gradients)
    trace = np.trace(hessians, axis1=1, axis2=2)
    mean = (along - steepness**2 * trace) / (2.0 * steepness**3)
    gaussian = np.einsum("na,nab,nb->n", gradients, _adjugates(hessians), gradients) / steepness**4
    return gaussian, mean


def _adjugates(hessians: Hessians) -> Hessians:
    """Of symmetric matrices: rows of cross products of their rows."""
    a, b, c = hessians[:, 0], hessians[:, 1], hessians[:, 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=2)
