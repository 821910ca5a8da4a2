"""Where the slices lie: a short-axis stack, and long-axis planes through its middle."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from schemas.vocabulary import Structure, View
from worker.arrays import Vector
from worker.phantom.long_axis import LongAxis
from worker.surface_mesh import SurfaceMesh

_LONG_AXIS_VIEWS = (View.LAX_4CH, View.LAX_2CH, View.LAX_3CH)
_DEGREES_BETWEEN = 60.0


@dataclass(frozen=True, eq=False)
class SlicePlane:
    """A slice yet to be cut: (3,) origin in mm and (3,) unit normal, patient frame."""

    id: str
    view: View
    origin_mm: Vector
    normal: Vector


def short_axis_stack(
    meshes: Iterable[Mapping[Structure, SurfaceMesh]],
    axis: LongAxis,
    spacing_mm: float,
    margin_mm: float = 0.0,
) -> list[SlicePlane]:
    """Planes across the axis, `spacing_mm` apart, from the base down, `sax-00` first.

    They span the surfaces of all `meshes` (one mapping a frame) and `margin_mm` beyond either end,
    with equal gaps at both ends. Normals point from base to apex.
    """
    along = np.concatenate(
        [(m.vertices_mm - axis.centre_mm) @ axis.towards_base for f in meshes for m in f.values()]
    )
    low, high = along.min() - margin_mm, along.max() + margin_mm
    count = max(1, int((high - low) // spacing_mm))
    top = (low + high) / 2.0 + spacing_mm * (count - 1) / 2.0
    return [
        SlicePlane(
            f"sax-{i:02d}",
            View.SAX,
            axis.centre_mm + axis.towards_base * (top - i * spacing_mm),
            -axis.towards_base,
        )
        for i in range(count)
    ]


def long_axis_planes(axis: LongAxis, count: int) -> list[SlicePlane]:
    """The first `count` of the four-, two- and three-chamber planes, which contain the long axis.

    The four-chamber plane goes through both ventricles; the others follow at 60 degrees each.
    """
    planes = []
    beside = np.cross(axis.towards_base, axis.towards_rv)
    for i, view in enumerate(_LONG_AXIS_VIEWS[:count]):
        turn = np.radians(_DEGREES_BETWEEN * i)
        normal = np.cos(turn) * beside - np.sin(turn) * axis.towards_rv
        planes.append(SlicePlane(f"lax-{i:02d}", view, axis.centre_mm, normal))
    return planes
