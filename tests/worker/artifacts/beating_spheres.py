"""Concentric spheres that beat: every number over the cycle has a closed form."""

import math

import numpy as np
import trimesh

from schemas.vocabulary import Structure, View
from worker.evaluation.distance import DirectedDistance
from worker.reconstruction.result import (
    ContourPoints,
    FrameFit,
    LevelFit,
    LevelSetCurvature,
    SliceFit,
)
from worker.surface_mesh import SurfaceMesh
from worker.tracking.tracked_surface import TrackedFrame, TrackedSurface

ENDO, EPI, RV = Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO
RADIUS_MM, EPI_MM, RV_MM, BESIDE_MM = 24.0, 34.0, 20.0, 60.0
PERIOD_MS = 800.0
PART = 0.25
"""Of its radius, what the cavity loses at end-systole."""

HEIGHTS_MM = (-12.0, -6.0, 0.0, 6.0, 12.0)
"""Of the short-axis slices."""

_BALL = trimesh.creation.icosphere(subdivisions=3)


def phase(index: int, count: int) -> float:
    """0 at end-diastole, 1 half a cycle later."""
    return math.sin(math.pi * index / count) ** 2


def radius_mm(index: int, count: int) -> float:
    return RADIUS_MM * (1.0 - PART * phase(index, count))


def epi_mm(index: int, count: int) -> float:
    """The wall keeps its volume."""
    wall = EPI_MM**3 - RADIUS_MM**3
    return float((radius_mm(index, count) ** 3 + wall) ** (1.0 / 3.0))


def ball(of_radius_mm: float, x_mm: float = 0.0) -> SurfaceMesh:
    vertices = np.asarray(_BALL.vertices) * of_radius_mm + np.array([x_mm, 0.0, 0.0])
    return SurfaceMesh(vertices, np.asarray(_BALL.faces, dtype=np.int64))


def ring(of_radius_mm: float, z_mm: float, x_mm: float = 0.0) -> ContourPoints:
    angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    across = math.sqrt(of_radius_mm**2 - z_mm**2)
    points = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(60)]) * across
    return ContourPoints(points + np.array([x_mm, 0.0, z_mm]), closed=True)


def radii_mm(index: int, count: int) -> dict[Structure, tuple[float, float]]:
    """Radius of each sphere and the x of its middle. The right one beats likewise, later."""
    right = RV_MM * (1.0 - PART * phase(index - 1, count))
    return {
        ENDO: (radius_mm(index, count), 0.0),
        EPI: (epi_mm(index, count), 0.0),
        RV: (right, BESIDE_MM),
    }


def frame(index: int, count: int, structures: tuple[Structure, ...] = (ENDO, EPI, RV)) -> FrameFit:
    """Labelled F0, F1, ...; at end-diastole the first."""
    wanted = {s: one for s, one in radii_mm(index, count).items() if s in structures}
    slices = tuple(
        SliceFit(
            id=f"sax-{number}",
            view=View.SAX,
            normal=np.array([0.0, 0.0, 1.0]),
            shift_mm=np.zeros(3),
            shift_deviation_mm=None,
            crossings=0,
            turn_rad=0.0,
            pivot_mm=np.zeros(3),
            contours_mm={s: (ring(r, z_mm, x_mm),) for s, (r, x_mm) in wanted.items()},
        )
        for number, z_mm in enumerate(HEIGHTS_MM)
    )
    ones = np.ones(len(_BALL.vertices))
    return FrameFit(
        label=f"F{index}",
        time_ms=index * PERIOD_MS / count,
        surfaces={s: ball(r, x_mm) for s, (r, x_mm) in wanted.items()},
        slices=slices,
        levels=(LevelFit(0, 4.0, 9, *(np.array(x) for x in ([0.6], [0.0], [0.6]))),),
        curvature={s: LevelSetCurvature(ones / r**2, ones / r) for s, (r, _) in wanted.items()},
    )


def tracked_frame(label: str, **changes: float) -> TrackedFrame:
    """Without a fault, but for what `changes` says; mean_mm is that of both distances."""
    mean_mm = changes.pop("mean_mm", 0.05)
    distance = DirectedDistance(mean_mm, mean_mm, mean_mm, mean_mm, mean_mm, mean_mm, 100)
    faults = {
        "turned_over": 0,
        "against_surface": 0,
        "folded": 0,
        "self_intersections": 0,
        "least_angle_deg": 30.0,
        "below_20_deg_percent": 0.0,
        "area_ratio_min": 1.0,
        "area_ratio_max": 1.0,
        "step_mean_mm": 0.0,
        "step_max_mm": 0.0,
    }
    return TrackedFrame(
        label=label, to_surface=distance, from_surface=distance, **(faults | changes)
    )


def tracked(meshes: list[SurfaceMesh], labels: list[str], rest: int = 0) -> TrackedSurface:
    """Meshes of one topology as a tracked surface."""
    return TrackedSurface(
        vertices_mm=np.stack([mesh.vertices_mm for mesh in meshes]),
        faces=meshes[0].faces,
        rest=rest,
        frames=tuple(tracked_frame(label) for label in labels),
        drift_mean_mm=None,
        drift_max_mm=None,
    )
