"""Which planes are a stack."""

import numpy as np
from numpy.typing import NDArray

_COSINE = float(np.cos(np.deg2rad(3.0)))
_LEAST = 3


def stack_of(normals: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which planes (n,) of these normals (n, 3) are of the largest family of parallel ones.

    None are where fewer than three are parallel.
    """
    unit = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    parallel = np.abs(unit @ unit.T) >= _COSINE
    sizes = parallel.sum(axis=1)
    if sizes.max() < _LEAST:
        return np.zeros(len(normals), dtype=np.bool_)
    found: NDArray[np.bool_] = parallel[int(np.argmax(sizes))]
    return found
