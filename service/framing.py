"""Requests that tell the end of their body twice: refused, and the connection with them.

Where a proxy believes `Content-Length` and we `Transfer-Encoding`, what one takes for a body the
other takes for a second request (RFC 9112, section 6.1).
"""

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from schemas.problem import InputError, ProblemType
from service.problems import problem_response


class OneFraming:
    """ASGI middleware: 400 for a request with `Content-Length` beside `Transfer-Encoding`."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            headers = Headers(scope=scope)
            if "content-length" in headers and "transfer-encoding" in headers:
                refused = InputError(
                    ProblemType.INVALID_REQUEST,
                    "the request has Content-Length and Transfer-Encoding. Remedy: send one of "
                    "them.",
                    status=400,
                )
                answer = problem_response(refused.problem(scope["path"]), {"Connection": "close"})
                await answer(scope, receive, send)
                return
        await self.app(scope, receive, send)
