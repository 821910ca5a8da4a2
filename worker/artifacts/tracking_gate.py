"""Whether a tracked mesh can stand for a frame's own surface, and what stands against it."""

from worker.tracking.tracked_surface import TrackedFrame
from worker.tracking.untangling import LEAST_ANGLE_DEG

LARGEST_MEAN_MM = 0.2
"""Mean distance to the frame's own surface, and back. Where truth is known that surface itself is
off by 0.07 to 0.17 mm on average."""


def tracking_faults(frame: TrackedFrame) -> list[str]:
    """Every reason why not, the gravest first, each with its remedy; none where it can."""
    return [*_of_triangles(frame), *_of_distance(frame), *_of_shape(frame)]


def _of_triangles(frame: TrackedFrame) -> list[str]:
    counts = (
        (frame.turned_over, "triangle", "turned over"),
        (frame.folded, "triangle", "folded onto a neighbour"),
        (frame.self_intersections, "pair of triangles", "passing through each other"),
    )
    return [
        f"It has {_many(count, thing)} {fault}; set another `target_edge_mm`, or take the frame's "
        "own surface."
        for count, thing, fault in counts
        if count
    ]


def _of_distance(frame: TrackedFrame) -> list[str]:
    mean_mm = max(frame.to_surface.mean_mm, frame.from_surface.mean_mm)
    if mean_mm <= LARGEST_MEAN_MM:
        return []
    return [
        f"It is {mean_mm:.2f} mm from the frame's own surface on average, more than "
        f"{LARGEST_MEAN_MM} mm; lower `target_edge_mm`, or take that surface."
    ]


def _of_shape(frame: TrackedFrame) -> list[str]:
    if frame.least_angle_deg >= LEAST_ANGLE_DEG:
        return []
    return [
        f"Its least angle is {frame.least_angle_deg:.1f} degrees, under {LEAST_ANGLE_DEG:.0f}; set "
        "another `target_edge_mm`."
    ]


def _many(count: int, thing: str) -> str:
    first, _, rest = thing.partition(" ")
    return f"{count} {first}{'' if count == 1 else 's'}{f' {rest}' if rest else ''}"
