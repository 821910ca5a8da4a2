"""What was observed of each surface, where alignment moved it to."""

from collections.abc import Mapping

from schemas.vocabulary import Structure
from worker.arrays import Scalars
from worker.evaluation.support import AlignedOutline, distance_to_outlines_mm
from worker.reconstruction.result import FrameFit

SUPPORT = "support_mm"
"""Name of the vertex property: distance to the nearest observed contour of the surface, mm."""


def aligned_outlines(fit: FrameFit) -> Mapping[Structure, tuple[AlignedOutline, ...]]:
    """The observed outlines of every structure of a frame, moved back by their slice's shift."""
    outlines: dict[Structure, tuple[AlignedOutline, ...]] = {}
    for one in fit.slices:
        for structure, contours in one.contours_mm.items():
            outlines[structure] = outlines.get(structure, ()) + tuple(
                AlignedOutline(one.id, one.view, one.aligned_mm(c.points_mm), c.closed)
                for c in contours
            )
    return outlines


def vertex_support_mm(fit: FrameFit) -> Mapping[Structure, Scalars]:
    """For every surface of a frame, the support of each of its vertices, (n,) mm.

    Raises InternalError for a surface that no contour was observed of.
    """
    outlines = aligned_outlines(fit)
    return {
        structure: distance_to_outlines_mm(mesh.vertices_mm, outlines.get(structure, ()))
        for structure, mesh in fit.surfaces.items()
    }
