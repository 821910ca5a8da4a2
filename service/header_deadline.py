"""Connections that never say what they want: given up after a while, as slow bodies are.

uvicorn itself waits for a request's headers for ever, so that a byte a minute holds a connection
and its file descriptor. `uvicorn --http service.header_deadline:HeaderDeadline` does not.
"""

import asyncio
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

HEADERS_WITHIN_S = "headers_within_s"
"""Under which the application's lifespan state says how long; where it does not, no bound."""


class HeaderDeadline(H11Protocol):
    """HTTP/1.1 whose requests have whole headers in time, or no connection.

    The time runs from the connection, or from the first byte of a later request on it, to the end
    of the headers. Nothing is answered: who sends a header a byte at a time waits for no answer.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._within_s: float | None = self.app_state.get(HEADERS_WITHIN_S)
        self._deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """One that sends nothing counts too."""
        super().connection_made(transport)
        self._start()

    def data_received(self, data: bytes) -> None:
        """Headers that are whole stop the clock; the first byte of later ones starts it."""
        super().data_received(data)
        if self.conn.their_state is not h11.IDLE:
            self._stop()
        elif self._deadline is None:
            self._start()

    def connection_lost(self, exc: Exception | None) -> None:
        """There is nothing left to wait for."""
        self._stop()
        super().connection_lost(exc)

    def _start(self) -> None:
        if self._within_s is not None:
            # Not `close`, which would wait for a caller who reads nothing.
            self._deadline = self.loop.call_later(self._within_s, self.transport.abort)

    def _stop(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None
