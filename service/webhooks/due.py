"""Which messages are to be sent now."""

from datetime import datetime

from service.webhooks.outbox import Outbox
from service.webhooks.outbox_index import OutboxIndex


class DueMessages:
    """Looks through an outbox, and clears it of what ended long ago."""

    def __init__(self, outbox: Outbox, kept: int) -> None:
        self._outbox = outbox
        self._kept = kept
        self._index = OutboxIndex(outbox)

    def of(self, endpoint_id: str, now: datetime) -> list[str]:
        """Ids of an endpoint's messages whose time has come, the most overdue first.

        Of those that have ended, all but the last `kept` are removed on the way.
        """
        seen = self._index.of(endpoint_id)
        ended = sorted(
            (seen_.version[0], message_id)
            for message_id, seen_ in seen.items()
            if seen_.next_at is None
        )
        for _, message_id in ended[: -self._kept]:
            self._outbox.drop(endpoint_id, message_id)
        due = [(s.next_at, message_id) for message_id, s in seen.items() if s.next_at is not None]
        return [message_id for next_at, message_id in sorted(due) if next_at <= now]
