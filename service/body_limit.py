"""A cap on the bytes of a request's body, counted as they arrive.

Starlette's own middleware answers in plain text where a Content-Length is too large; here it is a
problem like any other.
"""

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from schemas.problem import InputError, ProblemType


class BodyLimit:
    """ASGI middleware: reading beyond `max_bytes` raises InputError (too large, 413).

    A Content-Length is believed when it is too large, never when it is small. What is not read is
    not counted, and costs nothing.
    """

    def __init__(self, app: ASGIApp, max_bytes: int) -> None:
        self.app = app
        self.max_bytes = max_bytes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        declared = Headers(scope=scope).get("content-length", "")
        arrived = int(declared) if declared.isdecimal() else 0
        too_large = arrived > self.max_bytes
        arrived = 0

        async def counted() -> Message:
            nonlocal arrived
            if too_large:
                raise self._refusal()
            message = await receive()
            arrived += len(message.get("body", b""))
            if arrived > self.max_bytes:
                raise self._refusal()
            return message

        await self.app(scope, counted, send)

    def _refusal(self) -> InputError:
        return InputError(
            ProblemType.TOO_LARGE,
            f"the body has more than {self.max_bytes} bytes. Remedy: send fewer frames a job, "
            "resample contours to 100 to 300 points, or compress label maps (.nii.gz).",
            status=413,
        )
