"""What is suspicious about surfaces as meshes: their topology, and where they touch."""

from collections.abc import Sequence

from schemas.frame_report import FrameReport
from schemas.surface_report import SurfaceReport
from worker.artifacts.findings import Finding

_SELF, _HANDLES, _PIECES, _FORKS, _OPEN = 1.0, 2.0, 3.0, 4.0, 5.0
"""How bad a fault is beside the others: an open surface has not even a volume."""


def topology_findings(frames: Sequence[FrameReport], open_base: bool) -> list[Finding]:
    """Surfaces that are not one closed (or, with an open base, once rimmed) manifold sheet."""
    return [
        Finding(True, size, f"{frame.label} {structure}: {text}")
        for frame in frames
        for structure, surface in frame.surfaces.items()
        for size, text in _faults(surface, open_base)
    ]


def contact_findings(frames: Sequence[FrameReport]) -> list[Finding]:
    """Pairs of surfaces of which triangles pass through each other, each pair once."""
    found = []
    for frame in frames:
        for structure, surface in frame.surfaces.items():
            for other, count in surface.crossing_triangles.items():
                if count and (structure < other or other not in frame.surfaces):
                    text = (
                        f"{frame.label} {structure}: {count} of its {surface.faces} triangles pass "
                        f"through {other}, so the wall between them has no thickness there. Look "
                        "at both in 3D; lower `mesh.grid_mm`, or take one of the two."
                    )
                    found.append(Finding(False, float(count), text))
    return found


def _faults(surface: SurfaceReport, open_base: bool) -> list[tuple[float, str]]:
    faults = []
    wanted = 1 if open_base else 2
    closed = surface.watertight or open_base
    if not closed:
        faults.append(
            (_OPEN, "the surface is not closed, so it has no volume. Do not use it; report this.")
        )
    if not surface.manifold:
        faults.append(
            (
                _FORKS,
                "the surface is not manifold: sheets of it meet in an edge or a vertex. Do not "
                "compute on it; report this.",
            )
        )
    if surface.components > 1:
        faults.append(
            (
                _PIECES,
                f"the surface is in {surface.components} pieces instead of 1. Look for a contour "
                "of another structure, or for slices that are missing in between.",
            )
        )
    elif closed and surface.manifold and surface.euler_number != wanted:
        faults.append(
            (
                _HANDLES,
                f"the surface has a hole or a handle (Euler number {surface.euler_number} instead "
                f"of {wanted}). Look for a missing or misplaced contour, and at the base.",
            )
        )
    if surface.self_intersecting_triangles:
        faults.append(
            (
                _SELF,
                f"{surface.self_intersecting_triangles} of its {surface.faces} triangles pass "
                "through each other. Lower `mesh.grid_mm` or `target_edge_mm`.",
            )
        )
    return faults
