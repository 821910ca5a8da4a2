"""A stop signal is heard by all who wait, and means what it meant."""

import asyncio
import os
import signal
import threading
from types import FrameType

import pytest

from service.stop_signal import on_stop_signal


@pytest.mark.parametrize("sign", [signal.SIGTERM, signal.SIGINT])
def test_both_hear_it_and_afterwards_all_is_as_before(sign: signal.Signals) -> None:
    heard: list[str] = []

    def handler(_number: int, _frame: FrameType | None) -> None:
        heard.append("server")

    async def run() -> None:
        told = asyncio.Event()
        with on_stop_signal(told.set):
            os.kill(os.getpid(), sign)
            async with asyncio.timeout(5.0):
                await told.wait()
        assert signal.getsignal(sign) is handler

    before = signal.signal(sign, handler)
    try:
        asyncio.run(run())
    finally:
        signal.signal(sign, before)
    assert heard == ["server"]


def test_a_signal_without_a_handler_keeps_its_meaning() -> None:
    async def run() -> None:
        with on_stop_signal(lambda: None):
            assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL

    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    asyncio.run(run())


def test_other_threads_have_no_signals() -> None:
    done = []

    async def run() -> None:
        with on_stop_signal(lambda: None):
            done.append(True)

    thread = threading.Thread(target=lambda: asyncio.run(run()))
    thread.start()
    thread.join()
    assert done == [True]
