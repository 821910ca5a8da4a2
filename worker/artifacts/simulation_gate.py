"""Whether a surface can go into a simulation as it is, and what stands against it."""

from collections.abc import Mapping
from dataclasses import dataclass

from schemas.surface_report import SimulationReport
from schemas.vocabulary import Structure

SMALLEST_ANGLE_DEG = 20.0
"""Triangles with a smaller angle spoil the condition of finite-element matrices."""


@dataclass(frozen=True)
class SurfaceFaults:
    """What counts against a surface.

    rims: boundary loops; an open base has one on purpose. crossing: how many of its triangles
    pass through each other surface. sliver_percent: share of triangles under the smallest angle.
    """

    open_base: bool
    rims: int
    manifold: bool
    components: int
    euler_number: int
    self_intersecting: int
    crossing: Mapping[Structure, int]
    sliver_percent: float
    remeshed: bool


def simulation_report(faults: SurfaceFaults) -> SimulationReport:
    """Fit, or every reason why not, the gravest first."""
    reasons = [*_of_topology(faults), *_of_contact(faults), *_of_shape(faults)]
    return SimulationReport(fit=not reasons, reasons=reasons)


def _of_topology(faults: SurfaceFaults) -> list[str]:
    reasons = []
    wanted = 1 if faults.open_base else 0
    if not faults.manifold:
        reasons.append("It is not manifold: surfaces meet in an edge or a vertex; report this.")
    if faults.rims != wanted:
        reasons.append(
            f"It has {_many(faults.rims, 'rim')} where {wanted} should be; "
            + ("move the base or close it." if faults.open_base else "report this.")
        )
    if faults.components > 1:
        reasons.append(
            f"It is in {faults.components} pieces; look for a contour of another structure."
        )
    elif faults.manifold and faults.rims == wanted and faults.euler_number != 2 - wanted:
        handles = (2 - wanted - faults.euler_number) // 2
        reasons.append(
            f"It has {_many(handles, 'handle')}; look for a missing or misplaced contour there."
        )
    return reasons


def _of_contact(faults: SurfaceFaults) -> list[str]:
    reasons = []
    if faults.self_intersecting:
        reasons.append(
            f"{_many(faults.self_intersecting, 'triangle')} of it pass through each other; lower "
            "`mesh.grid_mm` or `target_edge_mm`."
        )
    for other, count in faults.crossing.items():
        if count:
            reasons.append(
                f"{_many(count, 'triangle')} of it pass through {other}, where both touch or are "
                "closer than a triangle is wide; lower `mesh.grid_mm` or `target_edge_mm`, or take "
                "one of the two."
            )
    return reasons


def _of_shape(faults: SurfaceFaults) -> list[str]:
    if not faults.sliver_percent:
        return []
    remedy = "set another `target_edge_mm`" if faults.remeshed else "set `target_edge_mm`"
    return [
        f"{faults.sliver_percent:.2g} % of its triangles have an angle under "
        f"{SMALLEST_ANGLE_DEG:.0f} degrees; {remedy}."
    ]


def _many(count: int, thing: str) -> str:
    return f"{count} {thing}" + ("" if count == 1 else "s")
