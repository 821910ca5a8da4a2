"""Learning early that the server was asked to stop.

uvicorn lets open answers finish before it tells the application; an answer that waits for a job
would use up all the time that this may take. So its signal handlers are listened to.
"""

import asyncio
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_SIGNALS = (signal.SIGTERM, signal.SIGINT)


@contextmanager
def on_stop_signal(tell: Callable[[], None]) -> Iterator[None]:
    """Have `tell` called in this event loop too when a signal asks the process to stop.

    Only a handler that is there is joined: a signal's meaning does not change. Outside of the main
    thread, where Python handles no signals, nothing happens.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    loop = asyncio.get_running_loop()
    joined: dict[signal.Signals, Any] = {}
    for sign in _SIGNALS:
        handler = signal.getsignal(sign)
        if callable(handler):
            joined[sign] = handler
            signal.signal(sign, _both(handler, lambda: loop.call_soon_threadsafe(tell)))
    try:
        yield
    finally:
        for sign, handler in joined.items():
            signal.signal(sign, handler)


def _both(
    handler: Callable[[int, FrameType | None], Any], tell: Callable[[], object]
) -> Callable[[int, FrameType | None], None]:
    def handle(number: int, frame: FrameType | None) -> None:
        tell()
        handler(number, frame)

    return handle
