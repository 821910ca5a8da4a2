"""One bit that a worker's parent raises and its children see: hand your job back, we are closing.

A page of memory shared over the fork: raising it is safe inside a signal handler, and reading it
costs nothing.
"""

import mmap

_PAGE = mmap.mmap(-1, 1)


def raise_flag() -> None:
    """Tell every child forked from this process."""
    _PAGE[0] = 1


def lower_flag() -> None:
    """Take it back; for a process that starts over."""
    _PAGE[0] = 0


def is_raised() -> bool:
    """Whether the parent closes."""
    return _PAGE[0] == 1
