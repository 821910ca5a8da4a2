"""Events as an event stream spells them: WHATWG HTML, section 9.2.6."""

from fastapi.sse import format_sse_event

from jobs.event_reader import StoredEvent

HEARTBEAT = format_sse_event(comment="still here")
REDIS_AWAY = format_sse_event(comment="the job records cannot be reached; waiting")


def event_text(event: StoredEvent) -> bytes:
    """One event, with the blank line that ends it."""
    return format_sse_event(id=str(event.id), event=event.kind.value, data_str=event.data)


def retry_text(after_s: int) -> bytes:
    """How long a client should wait before it connects again."""
    return format_sse_event(retry=after_s * 1000)
