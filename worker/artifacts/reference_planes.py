"""A surface and its reference on the planes of the slices, by kind of view."""

from collections.abc import Sequence

from schemas.reference_report import PlanesReport
from schemas.vocabulary import View, ViewKind
from worker.arrays import Vector
from worker.evaluation.plane_comparison import (
    PlaneComparison,
    PlanesComparison,
    compare_on_plane,
    pooled,
)
from worker.evaluation.summary import summarised
from worker.observer import Cancelled, Observer
from worker.surface_mesh import SurfaceMesh

ViewPlane = tuple[View, Vector, Vector]
"""A slice's view, and its plane: a point (3,) mm, and the normal (3,)."""


def planes_by_view(
    mesh: SurfaceMesh, reference: SurfaceMesh, planes: Sequence[ViewPlane], observer: Observer
) -> dict[ViewKind, PlanesReport]:
    """Both surfaces, closed and in one frame, cut by planes; a kind of view none of whose planes
    cuts both is left out. Raises Cancelled when the observer, asked at each plane, says so.
    """
    found: dict[ViewKind, list[PlaneComparison]] = {}
    for view, origin_mm, normal in planes:
        if observer.is_cancelled():
            raise Cancelled
        on_plane = compare_on_plane(mesh, reference, origin_mm, normal)
        if on_plane is not None:
            found.setdefault(view.kind, []).append(on_plane)
    return {kind: _report(pooled(every)) for kind, every in found.items()}


def _report(together: PlanesComparison) -> PlanesReport:
    return PlanesReport(
        planes=together.planes,
        distance_mm=summarised(together.distances_mm),
        dice_mean=together.dice_mean,
        dice_min=together.dice_min,
    )
