"""Reference meshes, read: surfaces in mm that could be the truth of this very study."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from intake.limits import Limits
from intake.references import check_reference_surfaces, reference_part
from intake.size import LARGEST_MM, SMALLEST_MM
from schemas.options import Options
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy, Frame
from worker.arrays import Points
from worker.mesh_file import read_surface
from worker.surface_mesh import SurfaceMesh


def read_references(
    files: Mapping[str, Path], study: ContourStudy, options: Options, limits: Limits
) -> tuple[dict[str, SurfaceMesh], list[str]]:
    """The references of an admitted study, by the surface that each is the truth of (`ED_lv_endo`).

    They are in mm and in the study's own axes, whatever its units. Returns sentences, too, about
    those that lie where the study has no contour.

    Raises:
        InputError: as `check_reference_surfaces` and `read_surface`; `IMPLAUSIBLE_SIZE` for one
            that is not as large as a heart, which is of another unit.
    """
    frames = check_reference_surfaces(study, options, files)
    references = {}
    for surface, path in files.items():
        part = reference_part(surface)
        references[surface] = read_surface(path, part, limits.max_mesh_triangles)
        _check_extent(references[surface], part)
    return references, [
        f"The reference {surface} lies apart from the contours of frame {frame.label}; is it in "
        f"the study's axes ({study.axes}), and of this study?"
        for surface, frame in frames.items()
        if _are_apart(references[surface], _contour_points(frame) * study.units.millimetres)
    ]


def _check_extent(mesh: SurfaceMesh, part: str) -> None:
    extent_mm = float(np.linalg.norm(np.ptp(mesh.vertices_mm, axis=0)))
    if not SMALLEST_MM <= extent_mm <= LARGEST_MM:
        raise InputError(
            ProblemType.IMPLAUSIBLE_SIZE,
            f"`{part}` spans {extent_mm:.3g} mm; a heart spans {SMALLEST_MM:g} to {LARGEST_MM:g} "
            "mm. Remedy: scale it to millimetres, whatever the units of the study.",
            pointer=part,
        )


def _are_apart(mesh: SurfaceMesh, points_mm: Points) -> bool:
    """Whether the boxes of a surface and of points have nothing in common."""
    low, high = mesh.vertices_mm.min(axis=0), mesh.vertices_mm.max(axis=0)
    return bool(np.any((low > points_mm.max(axis=0)) | (high < points_mm.min(axis=0))))


def _contour_points(frame: Frame) -> Points:
    return np.array([p for s in frame.slices for c in s.contours for p in c.points], dtype=float)
