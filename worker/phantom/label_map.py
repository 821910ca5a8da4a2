"""A phantom heart as NIfTI label maps: what a segmentation tool would have written."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import nibabel
import numpy as np
from jaxtyping import Float, Int

from schemas.label_schemes import published_labels
from schemas.labels import LabelScheme, TissueLabels
from schemas.vocabulary import View
from worker.arrays import Points, Vector
from worker.labelmaps.scheme import Tissue, values_by_tissue
from worker.phantom.analytic_heart import Heart
from worker.phantom.planes import LONG_AXIS_DEGREES
from worker.phantom.pose import Pose

_LPS_TO_RAS = np.array([-1.0, -1.0, 1.0])
_IN_PLANE_MARGIN_MM = 16.0
_LAX_THICKNESS_MM = 8.0


def write_label_maps(
    heart: Heart,
    directory: Path,
    scheme: LabelScheme | TissueLabels,
    *,
    spacing_mm: float = 8.0,
    pixel_mm: float = 1.5,
    lax: Sequence[View] = tuple(LONG_AXIS_DEGREES),
    later: Sequence[Heart] = (),
    time_step_ms: float | None = None,
) -> dict[View, Path]:
    """Write `sax.nii.gz`, and one file a long-axis view, as uint8 in RAS; returns their paths.

    The short-axis stack passes both apex and base by a slice. `later` are further frames of the
    same heart, in the same pose: the maps are then 4D, `time_step_ms` apart.
    """
    frames = (heart, *later)
    low, high = _extent(frames)
    grids = {View.SAX: _short_axis(low, high, spacing_mm, pixel_mm)}
    for view in lax:
        grids[view] = _long_axis(view, low, high, pixel_mm)
    files = {}
    for view, grid in grids.items():
        labels = scheme if isinstance(scheme, TissueLabels) else published_labels(scheme, view)
        path = directory / f"{view.value}.nii.gz"
        _write(path, grid, frames, _value_of_tissue(labels), time_step_ms)
        files[view] = path
    return files


@dataclass(frozen=True, eq=False)
class _Grid:
    """Voxel index to the heart's own frame, mm: columns are the steps along i, j, k."""

    shape: tuple[int, int, int]
    steps_mm: Float[np.ndarray, "3 3"]
    first_mm: Vector

    def points_mm(self) -> Points:
        """Voxel centres, (n, 3), in C order of the index."""
        return np.indices(self.shape).reshape(3, -1).T @ self.steps_mm.T + self.first_mm


def _extent(frames: Sequence[Heart]) -> tuple[Vector, Vector]:
    """Corners of the box, in the heart's own frame, that holds every tissue of every frame."""
    solids = [solid for f in frames for solid in (f.layout.lv_outer, f.layout.rv)]
    centres = np.array([solid.centre_mm for solid in solids])
    reaches = np.array([solid.semi_axes_mm for solid in solids])
    low, high = (centres - reaches).min(axis=0), (centres + reaches).max(axis=0)
    high[2] = max(f.layout.base_mm for f in frames)
    return low, high


def _short_axis(low: Vector, high: Vector, spacing_mm: float, pixel_mm: float) -> _Grid:
    first = low - np.array([_IN_PLANE_MARGIN_MM, _IN_PLANE_MARGIN_MM, spacing_mm / 2])
    length = high - first + np.array([_IN_PLANE_MARGIN_MM, _IN_PLANE_MARGIN_MM, spacing_mm])
    steps = np.array([pixel_mm, pixel_mm, spacing_mm])
    i, j, k = np.ceil(length / steps).astype(int).tolist()
    return _Grid((i, j, k), np.diag(steps), first)


def _long_axis(view: View, low: Vector, high: Vector, pixel_mm: float) -> _Grid:
    turn = np.radians(LONG_AXIS_DEGREES[view])
    across = np.array([np.cos(turn), np.sin(turn), 0.0])
    along = np.array([0.0, 0.0, 1.0])
    half = float(np.abs([low, high]).max(axis=0)[:2].max()) + _IN_PLANE_MARGIN_MM
    bottom = low[2] - _IN_PLANE_MARGIN_MM
    shape = (
        int(np.ceil(2 * half / pixel_mm)),
        int(np.ceil((high[2] + _IN_PLANE_MARGIN_MM - bottom) / pixel_mm)),
        1,
    )
    normal = np.cross(across, along)
    steps = np.column_stack([across * pixel_mm, along * pixel_mm, normal * _LAX_THICKNESS_MM])
    return _Grid(shape, steps, -half * across + bottom * along)


def _value_of_tissue(labels: TissueLabels) -> Int[np.ndarray, " n"]:
    """Label value by tissue; a tissue that the scheme lacks in this view is left background."""
    values = np.zeros(len(Tissue), dtype=np.int64)
    for tissue, listed in values_by_tissue(labels).items():
        values[tissue] = listed[0] if listed else 0
    return values


def _write(
    path: Path,
    grid: _Grid,
    frames: Sequence[Heart],
    values: Int[np.ndarray, " n"],
    time_step_ms: float | None,
) -> None:
    own_mm = grid.points_mm()
    maps = [values[f.contains(f.pose.to_patient(own_mm))].reshape(grid.shape) for f in frames]
    voxels = np.stack(maps, axis=-1) if len(maps) > 1 else maps[0]
    image = nibabel.Nifti1Image(voxels.astype(np.uint8), _affine_mm(grid, frames[0].pose))
    image.header.set_sform(image.affine, code="scanner")
    image.header.set_qform(image.affine, code="scanner")
    image.header.set_xyzt_units("mm", "msec")
    if len(maps) > 1 and time_step_ms is not None:
        image.header["pixdim"][4] = time_step_ms
    nibabel.save(image, path)


def _affine_mm(grid: _Grid, pose: Pose) -> Float[np.ndarray, "4 4"]:
    """Voxel index to RAS mm: the pose is rigid, so four points tell it."""
    corners = grid.first_mm + np.vstack([np.zeros(3), grid.steps_mm.T])
    origin, *ends = pose.to_patient(corners) * _LPS_TO_RAS
    affine = np.eye(4)
    affine[:3, :3] = (np.array(ends) - origin).T
    affine[:3, 3] = origin
    return affine
