"""How many threads the arithmetic of a job uses: said explicitly, never left to the machine.

The count is part of a result: sums taken in another order differ in their last digits.
"""

import os

_COUNTS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")


def bind_libraries(count: int) -> None:
    """Bound every arithmetic library that this process loads from now on to `count` threads."""
    for name in _COUNTS:
        os.environ[name] = str(count)


def use_threads(count: int) -> None:
    """Have torch, which is loaded here if it is not yet, use `count` threads."""
    import torch

    torch.set_num_threads(count)
