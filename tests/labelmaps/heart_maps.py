"""A small heart of nested ellipsoids as label maps: 0 background, 1 LV cavity, 2 LV wall, 3 RV."""

import numpy as np

PIXEL_MM = 2.0
SPACING_MM = 8.0
LV_SEMI_AXES_MM = np.array([22.0, 22.0, 42.0])
WALL_MM = 8.0

SAX_AFFINE = np.array(
    [
        [PIXEL_MM, 0.0, 0.0, -60.0],
        [0.0, PIXEL_MM, 0.0, -50.0],
        [0.0, 0.0, SPACING_MM, -64.0],
        [0.0, 0.0, 0.0, 1.0],
    ]
)
"""12 slices, the outer ones empty, RAS mm; the LV is centred at the origin."""
SAX_SHAPE = (64, 50, 16)

LAX_AFFINE = np.array(
    [
        [PIXEL_MM, 0.0, 0.0, -60.0],
        [0.0, 0.0, -SPACING_MM, 0.0],
        [0.0, PIXEL_MM, 0.0, -64.0],
        [0.0, 0.0, 0.0, 1.0],
    ]
)
"""One plane, y = 0, through both ventricles."""
LAX_SHAPE = (64, 64, 1)


def tissue(points_mm: np.ndarray) -> np.ndarray:
    """Tissue at (..., 3) points, RAS mm."""

    def inside(centre: list[float], semi_axes_mm: np.ndarray) -> np.ndarray:
        return (((points_mm - centre) / semi_axes_mm) ** 2).sum(axis=-1) < 1.0

    labels = np.zeros(points_mm.shape[:-1], dtype=np.uint8)
    labels[inside([26.0, 0.0, 4.0], np.array([30.0, 30.0, 38.0]))] = 3
    labels[inside([0.0, 0.0, 0.0], LV_SEMI_AXES_MM + WALL_MM)] = 2
    labels[inside([0.0, 0.0, 0.0], LV_SEMI_AXES_MM)] = 1
    return labels


def labels_on(shape: tuple[int, ...], affine: np.ndarray) -> np.ndarray:
    """Labels at the voxel centres of a grid."""
    index = np.moveaxis(np.indices(shape), 0, -1)
    return tissue(index @ affine[:3, :3].T + affine[:3, 3])


def sax() -> np.ndarray:
    return labels_on(SAX_SHAPE, SAX_AFFINE)


def lax() -> np.ndarray:
    return labels_on(LAX_SHAPE, LAX_AFFINE)


def renamed(labels: np.ndarray, names: dict[int, int]) -> np.ndarray:
    """Labels with other values, such as those of another scheme."""
    table = np.arange(256)
    for old, new in names.items():
        table[old] = new
    return table[labels].astype(labels.dtype)


ACDC_NAMES = {1: 3, 3: 1}
"""To exchange the values of the ventricles, as ACDC and M&Ms do."""
