"""Shape of a chamber: its length, how round it is, and its area half-way."""

import math

import numpy as np

from worker.arrays import Vector
from worker.evaluation.section import section
from worker.surface_mesh import SurfaceMesh


def long_axis_length_mm(mesh: SurfaceMesh, toward_base: Vector) -> float:
    """Extent of a chamber from apex to base along the unit vector `toward_base` (3,), mm."""
    return float(np.ptp(mesh.vertices_mm @ toward_base))


def sphericity(volume_ml: float, length_mm: float) -> float:
    """Volume over that of a sphere as wide as the chamber is long: 1 for a sphere, less for a
    slender chamber (the three-dimensional sphericity index of echocardiography).
    """
    return volume_ml / (math.pi / 6.0 * (length_mm / 10.0) ** 3)


def mid_area_cm2(mesh: SurfaceMesh, toward_base: Vector) -> float:
    """Area across a closed, outward chamber half-way between apex and base, cm2."""
    middle = _middle_mm(mesh, toward_base)
    doubled = [
        np.cross(loop - middle, np.roll(loop, -1, axis=0) - middle).sum(axis=0)
        for loop in section(mesh, middle, toward_base)
    ]
    return float(np.sum(doubled, axis=0) @ toward_base / 2.0 / 100.0)


def mid_perimeter_mm(mesh: SurfaceMesh, toward_base: Vector) -> float:
    """Length of the outline of a closed chamber half-way between apex and base, mm: of the longest,
    where there are several.
    """
    loops = section(mesh, _middle_mm(mesh, toward_base), toward_base)
    lengths = [np.linalg.norm(loop - np.roll(loop, -1, axis=0), axis=1).sum() for loop in loops]
    return float(max(lengths, default=0.0))


def _middle_mm(mesh: SurfaceMesh, toward_base: Vector) -> Vector:
    """A point half-way up."""
    heights = mesh.vertices_mm @ toward_base
    middle: Vector = 0.5 * (heights.min() + heights.max()) * toward_base
    return middle
