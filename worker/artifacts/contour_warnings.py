"""Plain words where contours of different views contradict each other."""

_NOTABLE_MM = 1.0
"""Less than a pixel of a usual cine image, and more than a careful hand strays."""


def contour_warnings(label: str, contour_noise_mm: float | None) -> list[str]:
    """One sentence for a frame whose crossing contours miss each other by much, or none."""
    if contour_noise_mm is None or contour_noise_mm < _NOTABLE_MM:
        return []
    return [
        f"{label}: contours of long-axis slices miss those of the short-axis slices that they "
        f"cross by {contour_noise_mm:.1f} mm, beyond what moving slices explains; the surface runs "
        "between them. Check the contours, and whether the views belong to one heartbeat and one "
        "frame of reference."
    ]
