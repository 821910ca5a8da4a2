"""Headers that every response carries, and problem documents for errors in plain text."""

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.problems import MEDIA_TYPE, problem_of_status, problem_response
from service.security_headers import SECURITY_HEADERS

_KEPT = ("allow", "content-range", "retry-after", "vary")


class ResponseHeaders:
    """ASGI middleware: every answer has the security headers, its own values first.

    An error that a library answers in its own words (a range that cannot be satisfied, say) is
    replaced by the problem document for its status.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        replaced = False

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in SECURITY_HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        async def send_screened(message: Message) -> None:
            nonlocal replaced
            if message["type"] == "http.response.start" and _is_plain_error(message):
                replaced = True
                await _send_problem(message, scope, receive, send_with_headers)
            elif not replaced:
                await send_with_headers(message)

        await self.app(scope, receive, send_screened)


def _is_plain_error(message: Message) -> bool:
    media_type = Headers(raw=message["headers"]).get("content-type", "")
    return bool(message["status"] >= 400 and not media_type.startswith(MEDIA_TYPE))


async def _send_problem(message: Message, scope: Scope, receive: Receive, send: Send) -> None:
    problem = problem_of_status(message["status"], None, scope["path"])
    kept = {
        name: value
        for name, value in Headers(raw=message["headers"]).items()
        if name in _KEPT or name.startswith("access-control-")
    }
    await problem_response(problem, kept)(scope, receive, send)
