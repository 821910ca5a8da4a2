"""Whether the time of day can be believed: what is erased by mistake does not come back."""

import time
from datetime import datetime, timedelta

_AGREE_WITHIN = timedelta(minutes=5)


class Clocks:
    """Holds three clocks against one another: this host's, Redis's, and the time since boot.

    The last is never set. From when this is made, the time of day may gain or lose five minutes on
    it; after a jump it is not believed until it is set back, or whoever runs the service has looked
    and started it anew.
    """

    def __init__(self) -> None:
        self._offset_s = time.time() - _since_boot_s()

    def doubt(self, redis_now: datetime) -> str | None:
        """Why the time is not to be believed; None where it is."""
        now_s = time.time()
        jumped = timedelta(seconds=now_s - _since_boot_s() - self._offset_s)
        if abs(jumped) > _AGREE_WITHIN:
            return (
                f"the clock was set by {jumped.total_seconds():.0f} s since the service began. "
                "Remedy: see that it is right, then restart the service"
            )
        apart = timedelta(seconds=redis_now.timestamp() - now_s)
        if abs(apart) > _AGREE_WITHIN:
            return (
                f"Redis's clock is {apart.total_seconds():.0f} s from this host's. Remedy: set "
                "both by one time server"
            )
        return None


def _since_boot_s() -> float:
    """Goes on while the machine sleeps, where the system can tell."""
    return time.clock_gettime(getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC))
