"""W3C Trace Context: the header `traceparent`, read and written (www.w3.org/TR/trace-context)."""

import re
import secrets
from dataclasses import dataclass, replace

_HEADER = re.compile(r"([0-9a-f]{2})-([0-9a-f]{32})-([0-9a-f]{16})-([0-9a-f]{2})(-.*)?")
_SAMPLED = 0x01


@dataclass(frozen=True)
class TraceContext:
    """A place in a trace.

    trace_id: the same for all that one request brings about. span_id: of this place alone.
    is_sampled: whether whoever began the trace records it.
    """

    trace_id: str
    span_id: str
    is_sampled: bool = False

    @classmethod
    def begun(cls) -> "TraceContext":
        """A new trace, that nobody is known to record."""
        return cls(_drawn(16), _drawn(8))

    @classmethod
    def parsed(cls, header: str | None) -> "TraceContext | None":
        """What a header says; None where there is none, or none that the standard lets pass.

        A version above ours is read as far as ours goes, as the standard asks.
        """
        found = _HEADER.fullmatch(header.strip()) if header else None
        if found is None:
            return None
        version, trace_id, span_id, flags, more = found.groups()
        if version == "ff" or (version == "00" and more) or not (_is_id(trace_id, span_id)):
            return None
        return cls(trace_id, span_id, bool(int(flags, 16) & _SAMPLED))

    def child(self) -> "TraceContext":
        """A place of its own, below this one."""
        return replace(self, span_id=_drawn(8))

    def header(self) -> str:
        return f"00-{self.trace_id}-{self.span_id}-{_SAMPLED if self.is_sampled else 0:02x}"


def _drawn(count: int) -> str:
    """Random bytes in hex, never all zero: that is no id."""
    while True:
        drawn = secrets.token_hex(count)
        if _is_id(drawn):
            return drawn


def _is_id(*ids: str) -> bool:
    return all(id_.strip("0") for id_ in ids)
