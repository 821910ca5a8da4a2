"""Columns of a tracked mesh: whether it is sound, and how far it drifts."""

from benchmarks.beating.results import TrackedRow
from benchmarks.tables.markdown import number

FAULTS = ("turned over", "folded", "self-intersecting", "least angle", "drift mean / max, mm")


def faults(mesh: TrackedRow) -> tuple[str, ...]:
    """Under `FAULTS`."""
    return (
        *(str(count) for count in (mesh.turned_over, mesh.folded, mesh.self_intersections)),
        f"{number(mesh.least_angle_deg, 1)}°",
        f"{number(mesh.drift_mean_mm, 2)} / {number(mesh.drift_max_mm, 1)}",
    )
