"""Computing gives way: the API and Redis on the same cores are answered before a fit goes on."""

import logging
import os
from pathlib import Path

_LOGGER = logging.getLogger(__name__)

_AUTOGROUP = Path("/proc/self/autogroup")


def give_way(nice: int) -> None:
    """Make this process, and what it forks, nicer by as much. Nobody takes it back."""
    os.nice(nice)


def let_session_give_way(nice: int, autogroup: Path = _AUTOGROUP) -> None:
    """Have the kernel take this session for so nice as a whole, where it looks at sessions.

    Linux with autogroups shares the cores among sessions first, and a process's own niceness counts
    only within its session; a worker of `neuralmri serve` is a session by itself.
    """
    try:
        if autogroup.exists():
            autogroup.write_text(str(nice))
    except OSError as error:
        _LOGGER.info("the session's niceness stays as it was: %s", error)
