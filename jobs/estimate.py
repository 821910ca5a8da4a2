"""When a waiting job will be started, from how long jobs take and how many are done at a time."""

import math


def start_in_s(ahead: int, running: int, slots: int, runtime_s: float) -> float:
    """Expected time until a waiting job starts, s.

    Ends of jobs come `slots / runtime_s` a second while all slots are taken. A job needs one end
    for each job ahead that no free slot takes, and one for itself. Grows with `ahead`, `running`
    and `runtime_s`, shrinks with `slots`.

    Args:
        ahead: Jobs that will be started before it.
        running: Jobs that are worked on.
        slots: Jobs that all workers together do at a time, at least 1.
        runtime_s: Of a job, on average.
    """
    free = max(0, slots - running)
    return max(0, ahead + 1 - free) * runtime_s / slots


def retry_after_s(estimate_s: float | None, otherwise_s: int) -> int:
    """An estimate as a `Retry-After`: whole seconds, 1 to 3600; `otherwise_s` without one."""
    if estimate_s is None:
        return otherwise_s
    return max(1, min(3600, math.ceil(estimate_s)))
