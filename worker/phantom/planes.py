"""Where the slices lie: a short-axis stack, and long-axis planes through its middle."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import islice

import numpy as np

from schemas.vocabulary import Structure, View
from worker.arrays import Vector
from worker.phantom.long_axis import LongAxis
from worker.surface_mesh import SurfaceMesh

LONG_AXIS_DEGREES = {View.LAX_4CH: 0.0, View.LAX_2CH: 60.0, View.LAX_3CH: 120.0}
"""Turn of each long-axis plane about the LV's axis, from the plane through both ventricles."""


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

    They are turned by `LONG_AXIS_DEGREES`.
    """
    planes = []
    beside = np.cross(axis.towards_base, axis.towards_rv)
    for i, (view, degrees) in enumerate(islice(LONG_AXIS_DEGREES.items(), count)):
        turn = np.radians(degrees)
        normal = np.cos(turn) * beside - np.sin(turn) * axis.towards_rv
        planes.append(SlicePlane(f"lax-{i:02d}", view, axis.centre_mm, normal))
    return planes
