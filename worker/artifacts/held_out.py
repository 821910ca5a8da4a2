"""How far contours are from the surface that was fitted without their slice."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from schemas.vocabulary import Structure, View
from worker.arrays import SomeScalars
from worker.evaluation.residuals import all_distances_mm, contour_residuals
from worker.evaluation.support import AlignedOutline
from worker.reconstruction.result import FrameFit


@dataclass(frozen=True, eq=False)
class HeldOut:
    """One slice's contours of one surface: (n,) exact distances of their points, mm."""

    slice_id: str
    view: View
    distances_mm: SomeScalars


def held_out_distances(
    fit: FrameFit, outlines: Mapping[Structure, Sequence[AlignedOutline]]
) -> Mapping[Structure, Sequence[HeldOut]]:
    """By surface, for every slice that it was fitted without. outlines: aligned, by structure."""
    found: dict[Structure, list[HeldOut]] = {structure: [] for structure in fit.surfaces}
    for slice_id, surfaces in fit.held_out.items():
        for structure, mesh in surfaces.items():
            own = [one for one in outlines.get(structure, ()) if one.slice_id == slice_id]
            if own:
                distances_mm = all_distances_mm(contour_residuals(mesh, own))
                found[structure].append(HeldOut(slice_id, own[0].view, distances_mm))
    return found
