"""The left ventricle's wall: how thick it is, as a whole and segment by segment, and its mass."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from worker.arrays import Scalars
from worker.evaluation.aha_segments import APEX, NAMES, LeftVentricle, aha_segments
from worker.evaluation.distance import vertices_to_surface_mm
from worker.surface_mesh import SurfaceMesh

MYOCARDIUM_G_PER_ML = 1.05
"""Density of heart muscle, as clinical guidelines take it."""


@dataclass(frozen=True)
class SegmentThickness:
    """Of one segment: mean, least and largest over its vertices, mm."""

    mean_mm: float
    min_mm: float
    max_mm: float


def wall_mass_g(endo_ml: float, epi_ml: float) -> float:
    """Mass of the wall between two closed surfaces of these volumes, grams."""
    return MYOCARDIUM_G_PER_ML * (epi_ml - endo_ml)


def wall_thickness_mm(endo: SurfaceMesh, epi: SurfaceMesh) -> Scalars:
    """Thickness of the wall at each vertex of its inner surface: the exact distance to its outer
    one, (n,) mm. Where inner and outer surface are not parallel it is the shortest way through.
    """
    return vertices_to_surface_mm(endo, epi)


def thickness_by_segment(
    endo: SurfaceMesh, epi: SurfaceMesh, ventricle: LeftVentricle
) -> Mapping[int, SegmentThickness]:
    """Thickness of the seventeen segments, those without a vertex left out.

    Segments 1 to 16 are measured from the inner surface outward. The apex has no inner surface of
    its own: it is measured from the outer surface below the cavity inward.
    """
    thickness_mm = wall_thickness_mm(endo, epi)
    segment_of = aha_segments(endo.vertices_mm, ventricle)
    parts = {number: thickness_mm[segment_of == number] for number in NAMES if number != APEX}
    below = aha_segments(epi.vertices_mm, ventricle) == APEX
    parts[APEX] = vertices_to_surface_mm(epi, endo)[below]
    return {number: _summary(part) for number, part in parts.items() if len(part)}


def _summary(thickness_mm: np.ndarray) -> SegmentThickness:
    return SegmentThickness(
        float(thickness_mm.mean()), float(thickness_mm.min()), float(thickness_mm.max())
    )
