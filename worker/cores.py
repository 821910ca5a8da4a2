"""How many cores this process may use."""

import os


def usable_cores() -> int:
    """The machine's, or fewer where it is bound to some. A container's quota is not known here."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
