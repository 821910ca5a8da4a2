"""Plain words where outlines of different views contradict each other."""

_NOTABLE_MM = 1.0
"""Of observers whose outlines are compared, two are about a millimetre apart."""


def outline_warnings(label: str, outline_noise_mm: float | None) -> list[str]:
    """One sentence for a frame whose crossing outlines miss each other by much, or none."""
    if outline_noise_mm is None or outline_noise_mm < _NOTABLE_MM:
        return []
    return [
        f"{label}: contours of long-axis slices miss those of the short-axis slices that they "
        f"cross by {outline_noise_mm:.1f} mm, beyond what moving slices explains; the surface runs "
        "between them. Check the contours, and whether the views belong to one heartbeat and one "
        "frame of reference."
    ]
