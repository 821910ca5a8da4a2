"""How many attempts this process has made at messages, by what came of them."""

import threading
from collections import Counter

from schemas.webhook import DeliveryState
from service.webhooks.message import Message

DELIVERED, FAILED, GIVEN_UP = "delivered", "failed", "given_up"


class AttemptCounts:
    """Added to by the dispatcher's threads, read by others."""

    def __init__(self) -> None:
        self._counted = Counter({DELIVERED: 0, FAILED: 0, GIVEN_UP: 0})
        self._lock = threading.Lock()

    def note(self, message: Message) -> None:
        """One attempt more, after which the message is so. A failed one is the last, or is not."""
        if message.next_attempt_at is not None:
            result = FAILED
        else:
            result = DELIVERED if message.state is DeliveryState.DELIVERED else GIVEN_UP
        with self._lock:
            self._counted[result] += 1

    def totals(self) -> dict[str, int]:
        with self._lock:
            return dict(self._counted)
