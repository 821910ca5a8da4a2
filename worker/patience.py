"""Waiting for a job store that does not answer, as long as the attempt is not to stop."""

import logging
import random
import time
from collections.abc import Callable
from typing import TypeVar

from jobs.store_errors import StoreUnavailable

_FIRST_WAIT_S = 0.5
_LONGEST_WAIT_S = 15.0
_LOOK_EVERY_S = 0.25

_LOGGER = logging.getLogger(__name__)
_Result = TypeVar("_Result")


def patiently(
    step: Callable[[], _Result], is_stopped: Callable[[], bool], patience_s: float
) -> _Result:
    """Take a step in the store, and again after ever longer waits where it does not answer.

    Raises StoreUnavailable once `patience_s` are over or the attempt is to stop.
    """
    deadline = time.monotonic() + patience_s
    wait_s = _FIRST_WAIT_S
    while True:
        try:
            return step()
        except StoreUnavailable as error:
            if time.monotonic() + wait_s > deadline:
                raise
            _LOGGER.warning("the store took no step, once more in %.1f s: %s", wait_s, error)
            again_at = time.monotonic() + wait_s * random.uniform(0.5, 1.0)  # noqa: S311  no secret
            while time.monotonic() < again_at:
                if is_stopped():
                    raise
                time.sleep(_LOOK_EVERY_S)
            wait_s = min(2.0 * wait_s, _LONGEST_WAIT_S)
