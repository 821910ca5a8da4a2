"""Reading an event stream: WHATWG HTML, section 9.2.6, from bytes as they arrive."""

import codecs
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

_LINE_END = re.compile(r"\r\n|\n|\r")


@dataclass(frozen=True)
class ServerSentEvent:
    """One event. `last_event_id` is what to connect again with once it is dealt with."""

    event: str
    data: str
    last_event_id: str


def read_events(chunks: Iterable[bytes], last_event_id: str = "") -> Iterator[ServerSentEvent]:
    """The events of a stream. One that the stream's end cuts off is dropped."""
    event = ""
    data: list[str] = []
    for line in _lines(chunks):
        if not line:
            if data:
                yield ServerSentEvent(event or "message", "\n".join(data), last_event_id)
            event, data = "", []
            continue
        name, _, value = line.partition(":")
        value = value.removeprefix(" ")
        if name == "event":
            event = value
        elif name == "data":
            data.append(value)
        elif name == "id" and "\0" not in value:
            last_event_id = value


def _lines(chunks: Iterable[bytes]) -> Iterator[str]:
    """Whole lines, which CR, LF or both end, and nothing else: JSON may hold other separators."""
    decoder = codecs.getincrementaldecoder("utf-8")("replace")
    text, is_first = "", True
    for chunk in chunks:
        text += decoder.decode(chunk)
        if is_first and text:
            text, is_first = text.removeprefix("\ufeff"), False
        # The LF that may belong to a CR is perhaps in the next chunk.
        held = "\r" if text.endswith("\r") else ""
        *lines, text = _LINE_END.split(text.removesuffix(held))
        yield from lines
        text += held
