"""Stacks cut from shapes with a formula: an ellipsoid, leaning and away from the origin."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from schemas.vocabulary import Structure, View
from worker.reconstruction.slice_stack import Outline, SliceStack, StackSlice

STRUCTURE = Structure.LV_ENDO
TURN = Rotation.from_euler("xyz", (25.0, -40.0, 10.0), degrees=True).as_matrix()
CENTRE_MM = np.array([35.0, -120.0, 260.0])
AROUND = np.linspace(0.0, 2.0 * np.pi, 120, endpoint=False)


def in_space(points: np.ndarray) -> np.ndarray:
    return points @ TURN.T + CENTRE_MM


def cut(
    id_: str,
    view: View,
    origin: np.ndarray,
    normal: np.ndarray,
    rings: list[np.ndarray],
    *,
    closed: bool = True,
    absent: bool = False,
) -> StackSlice:
    """A slice in the shape's own frame, brought to patient mm."""
    outlines = tuple(Outline(in_space(ring), closed) for ring in rings)
    return StackSlice(
        id=id_,
        view=view,
        origin_mm=in_space(origin[None])[0],
        normal=TURN @ normal,
        outlines={STRUCTURE: outlines} if outlines else {},
        absent=frozenset({STRUCTURE} if absent else ()),
    )


def level_ring(
    height: float, radii: tuple[float, float], centre: tuple[float, float] = (0.0, 0.0)
) -> np.ndarray:
    """An ellipse (120, 3) across z."""
    x, y = centre[0] + radii[0] * np.cos(AROUND), centre[1] + radii[1] * np.sin(AROUND)
    return np.column_stack([x, y, np.full(len(AROUND), height)])


def short_axis(
    heights: list[float], rings: list[list[np.ndarray]], absent: tuple[float, ...] = ()
) -> list[StackSlice]:
    z = np.array([0.0, 0.0, 1.0])
    shown = [
        cut(f"sax-{h:g}", View.SAX, h * z, z, found)
        for h, found in zip(heights, rings, strict=True)
    ]
    return shown + [cut(f"no-{h:g}", View.SAX, h * z, z, [], absent=True) for h in absent]


@dataclass(frozen=True)
class EllipsoidStack:
    """A stack and the signed residual of points to the ellipsoid it was cut from, mm."""

    stack: SliceStack
    semi_axes_mm: tuple[float, float, float]

    @property
    def volume_ml(self) -> float:
        return float(4.0 / 3.0 * np.pi * np.prod(self.semi_axes_mm) / 1000.0)

    def off_mm(self, points_mm: np.ndarray) -> np.ndarray:
        """Signed distance to first order, exact on the surface."""
        q = (points_mm - CENTRE_MM) @ TURN / np.array(self.semi_axes_mm)
        level = np.linalg.norm(q, axis=1)
        slope = np.linalg.norm(q / np.array(self.semi_axes_mm), axis=1)
        return level * (level - 1.0) / slope


def ellipsoid(
    *,
    long_axis: bool = True,
    spacing_mm: float = 8.0,
    shifts_mm: tuple[float, ...] = (),
    open_above_mm: float | None = None,
) -> EllipsoidStack:
    """Short-axis slices from -36 mm every `spacing_mm`, the first ones moved along x by
    `shifts_mm`; two long-axis ones if asked, open above a height if given.
    """
    a, b, c = semi_axes = (22.0, 26.0, 40.0)
    top = c if open_above_mm is None else open_above_mm
    heights = [float(h) for h in np.arange(-36.0, top, spacing_mm)]
    moved = [*shifts_mm, *[0.0] * (len(heights) - len(shifts_mm))]
    rings = []
    for h, shift in zip(heights, moved, strict=True):
        share = float(np.sqrt(1.0 - (h / c) ** 2))
        rings.append([level_ring(h, (a * share, b * share), (shift, 0.0))])
    slices = short_axis(heights, rings)
    if long_axis:
        for id_, view, side, width in (
            ("lax-0", View.LAX_4CH, np.array([1.0, 0.0, 0.0]), a),
            ("lax-1", View.LAX_2CH, np.array([0.0, 1.0, 0.0]), b),
        ):
            up = np.array([0.0, 0.0, 1.0])
            ring = width * np.sin(AROUND)[:, None] * side - c * np.cos(AROUND)[:, None] * up
            if open_above_mm is not None:
                below = ring[:, 2] < open_above_mm
                # Begun at the rim: the highest point kept comes first.
                start = int(np.argmax(~below))
                ring = np.roll(ring, -start, axis=0)[np.roll(below, -start)]
            closed = open_above_mm is None
            slices.append(cut(id_, view, np.zeros(3), np.cross(up, side), [ring], closed=closed))
    return EllipsoidStack(SliceStack("ED", None, tuple(slices)), semi_axes)


def cylinder(
    count: int = 5, spacing_mm: float = 8.0, absent: tuple[float, ...] = (), parts: int = 1
) -> SliceStack:
    """Radius 20 mm along z, its first slice at 0; with two parts, the middle slice shows a smaller
    circle too.
    """
    heights = [k * spacing_mm for k in range(count)]
    rings = [[level_ring(h, (20.0, 20.0))] for h in heights]
    if parts == 2:
        rings[count // 2].insert(0, level_ring(heights[count // 2], (5.0, 5.0), (40.0, 0.0)))
    return SliceStack("ED", None, tuple(short_axis(heights, rings, absent)))


def heights_mm(points_mm: np.ndarray) -> np.ndarray:
    """z of points (n, 3) in the shape's own frame."""
    return (points_mm - CENTRE_MM) @ TURN[:, 2]
