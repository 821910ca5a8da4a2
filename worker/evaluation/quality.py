"""Whether triangles are fit for a simulation: neither needles nor caps."""

from dataclasses import dataclass

import numpy as np

from worker.arrays import Points, Scalars
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True)
class TriangleQuality:
    """Shape of the triangles of a mesh.

    min_angle_deg: each triangle's smallest angle, at best 60; here the mesh's smallest, 5th
        percentile and mean. below_20_deg_percent: share of triangles under 20 degrees.
    aspect_ratio: circumradius over twice the inradius, at best 1; here mean, 95th percentile and
        largest (inf for a triangle without area).
    edge_mean_mm, edge_p5_mm, edge_p95_mm: mean edge length, and its 5th and 95th percentile.
    """

    min_angle_deg: float
    min_angle_p5_deg: float
    min_angle_mean_deg: float
    below_20_deg_percent: float
    aspect_ratio_mean: float
    aspect_ratio_p95: float
    aspect_ratio_max: float
    edge_mean_mm: float
    edge_p5_mm: float
    edge_p95_mm: float


def triangle_quality(mesh: SurfaceMesh) -> TriangleQuality:
    """Angles, aspect ratios and edge lengths of all triangles of a mesh that has some."""
    first, second, third = (mesh.vertices_mm[mesh.faces[:, corner]] for corner in range(3))
    a, b, c = _length(first - second), _length(second - third), _length(third - first)
    edges = np.concatenate([a, b, c])
    angles = np.degrees(np.minimum(np.minimum(_angle(a, b, c), _angle(b, c, a)), _angle(c, a, b)))
    # R / 2r = abc / ((b + c - a)(c + a - b)(a + b - c))
    with np.errstate(divide="ignore", invalid="ignore"):
        aspect = a * b * c / np.maximum((b + c - a) * (c + a - b) * (a + b - c), 0.0)
    aspect[~np.isfinite(aspect)] = np.inf
    return TriangleQuality(
        min_angle_deg=float(angles.min()),
        min_angle_p5_deg=float(np.percentile(angles, 5.0)),
        min_angle_mean_deg=float(angles.mean()),
        below_20_deg_percent=float(100.0 * np.mean(angles < 20.0)),
        aspect_ratio_mean=float(aspect.mean()),
        aspect_ratio_p95=float(np.percentile(aspect, 95.0, method="lower")),
        aspect_ratio_max=float(aspect.max()),
        edge_mean_mm=float(edges.mean()),
        edge_p5_mm=float(np.percentile(edges, 5.0)),
        edge_p95_mm=float(np.percentile(edges, 95.0)),
    )


def _length(vectors: Points) -> Scalars:
    lengths: Scalars = np.sqrt(np.einsum("md,md->m", vectors, vectors))
    return lengths


def _angle(opposite: Scalars, left: Scalars, right: Scalars) -> Scalars:
    """Angle in radians by the law of cosines; 0 where a side has no length."""
    product = 2.0 * left * right
    cosine = (left**2 + right**2 - opposite**2) / np.where(product > 0.0, product, 1.0)
    angle: Scalars = np.where(product > 0.0, np.arccos(np.clip(cosine, -1.0, 1.0)), 0.0)
    return angle
