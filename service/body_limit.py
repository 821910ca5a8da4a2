"""A cap on the bytes of a request's body, counted as they arrive, and on the time they take.

Starlette's own middleware answers in plain text where a Content-Length is too large; here it is a
problem like any other.
"""

import asyncio

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from schemas.problem import InputError, ProblemType


class BodyLimit:
    """ASGI middleware: reading beyond `max_bytes` raises InputError (too large, 413).

    So does a body that is not there within `within_s` (408): who sends a byte a second must not
    hold a connection for ever. A Content-Length is believed when it is too large, never when it is
    small. What is not read is not counted, and costs nothing.
    """

    def __init__(self, app: ASGIApp, max_bytes: int, within_s: float) -> None:
        self.app = app
        self.max_bytes = max_bytes
        self.within_s = within_s

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        declared = Headers(scope=scope).get("content-length", "")
        arrived = int(declared) if declared.isdecimal() else 0
        too_large = arrived > self.max_bytes
        arrived = 0
        is_whole = False
        deadline = asyncio.get_running_loop().time() + self.within_s

        async def counted() -> Message:
            nonlocal arrived, is_whole
            if too_large:
                raise self._too_large()
            if is_whole:  # what comes now is the end of the connection, at its own time
                return await receive()
            try:
                async with asyncio.timeout_at(deadline):
                    message = await receive()
            except TimeoutError as error:
                raise self._too_slow() from error
            arrived += len(message.get("body", b""))
            is_whole = not message.get("more_body", False)
            if arrived > self.max_bytes:
                raise self._too_large()
            return message

        await self.app(scope, counted, send)

    def _too_slow(self) -> InputError:
        return InputError(
            ProblemType.INVALID_REQUEST,
            f"the body was not there within {self.within_s:g} s. Remedy: send it again over a "
            "faster line, fewer frames a job, or label maps compressed (.nii.gz).",
            status=408,
        )

    def _too_large(self) -> InputError:
        return InputError(
            ProblemType.TOO_LARGE,
            f"the body has more than {self.max_bytes} bytes. Remedy: send fewer frames a job, "
            "resample contours to 100 to 300 points, or compress label maps (.nii.gz).",
            status=413,
        )
