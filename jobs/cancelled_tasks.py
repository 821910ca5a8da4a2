"""Ending tasks of an event loop that talk to Redis."""

import asyncio


async def end_tasks(*tasks: "asyncio.Task[None]") -> None:
    """Cancel the tasks and return once they have ended, however they did.

    They are cancelled until they heed it: up to Python 3.11 `asyncio.wait_for`, through which the
    Redis client sends, loses a cancellation that comes in the instant in which it is done.
    """
    left = set(tasks)
    while left:
        for task in left:
            task.cancel()
        _, left = await asyncio.wait(left, timeout=0.05)
