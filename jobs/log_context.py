"""What a log line says beside its message: which job, which attempt, which stage, which trace.

Held where the code that runs for one request or one attempt finds it, so that it need not be handed
through every call. Only ids and counts: nothing that a caller wrote.
"""

from contextvars import ContextVar
from dataclasses import dataclass

from jobs.trace_context import TraceContext
from schemas.job import Stage


@dataclass
class LogContext:
    """Changed in place as more becomes known, so that threads that share it say the same."""

    job_id: str | None = None
    attempt: int | None = None
    stage: Stage | None = None
    trace: TraceContext | None = None

    def fields(self) -> dict[str, str | int]:
        """What is known."""
        known = {
            "job_id": self.job_id,
            "attempt": self.attempt,
            "stage": self.stage.value if self.stage else None,
            "trace_id": self.trace.trace_id if self.trace else None,
        }
        return {name: value for name, value in known.items() if value is not None}


_CURRENT: ContextVar[LogContext | None] = ContextVar("log_context", default=None)


def enter(context: LogContext) -> LogContext:
    """From here on this request or attempt is what lines are about, until the next is entered.

    It is not left again: whoever reports an error further out still knows whose it was.
    """
    _CURRENT.set(context)
    return context


def current() -> LogContext:
    """What lines are about now. One that nobody holds where nothing was entered."""
    return _CURRENT.get() or LogContext()
