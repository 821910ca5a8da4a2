"""A surface in parts, to be measured part by part: thirds along the heart, septum and free wall."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from schemas.reference_report import Region
from schemas.vocabulary import Structure
from worker.arrays import SomePoints, Vector
from worker.evaluation.septum import NoSeptum, SomeFlags, septum
from worker.evaluation.thirds import thirds
from worker.surface_mesh import SurfaceMesh

InRegion = Callable[[SomePoints, SomePoints], SomeFlags]
"""Whether each of (n, 3) points, mm, with outward unit normals (n, 3), is part of a region."""


@dataclass(frozen=True, eq=False)
class Regions:
    """parts: by name, what belongs to it: every point to one third, and to septum or free wall.

    not_split: "thirds" or "septum", where the surface is not split that way, and the reason.
    """

    parts: Mapping[Region, InRegion]
    not_split: Mapping[str, str]


def regions(
    structure: Structure, surfaces: Mapping[Structure, SurfaceMesh], toward_base: Vector | None
) -> Regions:
    """The parts of one of a frame's surfaces; they also split what lies near it, as its reference.

    surfaces: of the frame, mm, that one among them. toward_base: (3,) the unit vector along the
    long axis, None where it is not known.
    """
    parts: dict[Region, InRegion] = {}
    not_split: dict[str, str] = {}
    if toward_base is None:
        not_split["thirds"] = "Without short-axis slices the long axis is not known."
    else:
        third = thirds(surfaces[structure], toward_base).of
        parts["apex"] = lambda points, _: third(points) == 0
        parts["mid"] = lambda points, _: third(points) == 1
        parts["base"] = lambda points, _: third(points) == 2
    septal = septum(structure, surfaces, toward_base)
    if isinstance(septal, NoSeptum):
        not_split["septum"] = septal.reason
    else:
        parts["septum"] = septal
        parts["free_wall"] = lambda points, normals: ~septal(points, normals)
    return Regions(parts, not_split)
