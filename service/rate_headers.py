"""The headers RateLimit and RateLimit-Policy: draft-ietf-httpapi-ratelimit-headers-10."""

import math

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from jobs.rate_bucket import Taken


class RateHeaders:
    """ASGI middleware: answers to requests that were counted say what is left."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return

        async def send_with_rate(message: Message) -> None:
            taken: Taken | None = scope.get("state", {}).get("rate")
            if message["type"] == "http.response.start" and taken:
                headers = MutableHeaders(scope=message)
                headers["RateLimit-Policy"] = ", ".join(
                    f'"{level.policy.name}";q={level.policy.quota};w={level.policy.window_s}'
                    for level in taken.levels
                )
                headers["RateLimit"] = ", ".join(
                    f'"{level.policy.name}";r={level.remaining};t={math.ceil(level.full_in_s)}'
                    for level in taken.levels
                )
            await send(message)

        await self.app(scope, receive, send_with_rate)
