"""Vertices pulled onto the level set by Newton steps along the field's gradient."""

from collections.abc import Callable

import numpy as np

from worker.arrays import Points

LogitsAndGradient = Callable[[Points], tuple[np.ndarray, np.ndarray]]
"""(n, 3) points to logits (n,) and their gradients (n, 3) of one surface."""


def project(
    vertices: Points, logits_and_gradient: LogitsAndGradient, steps: int, reach: float
) -> Points:
    """Vertices (n, 3) after `steps` Newton steps, none moved further than `reach` in all.

    Where the gradient vanishes a vertex stays. Units are the callable's.
    """
    moved = vertices
    for _ in range(steps):
        logits, gradients = logits_and_gradient(moved)
        squared = np.maximum((gradients**2).sum(axis=1), 1e-12)
        moved = moved - (logits / squared)[:, None] * gradients
        offset = moved - vertices
        length = np.linalg.norm(offset, axis=1, keepdims=True)
        moved = vertices + offset * np.minimum(1.0, reach / np.maximum(length, 1e-12))
    return moved
