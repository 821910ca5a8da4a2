"""Pages of other origins: what a browser may do here on their behalf, which is nothing unless set.

Two halves. CORS lets the pages that a setting names read answers. And whoever is not named cannot
change anything either: a form on any page can be sent to a service on loopback or behind a login,
and a browser sends it without asking CORS first.
"""

from collections.abc import Collection
from typing import Any
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from schemas.problem import InputError, ProblemType
from service.problems import problem_response

_SAFE_METHODS = ("GET", "HEAD", "OPTIONS")


def cors(origins: Collection[str]) -> dict[str, Any]:
    """The arguments of Starlette's CORSMiddleware that let pages of `origins` use the whole API.

    Cookies are never sent along: there are none here.
    """
    return {
        "allow_origins": origins,
        "allow_methods": ("GET", "HEAD", "POST", "DELETE"),
        "allow_headers": (
            *("Authorization", "X-API-Key", "Content-Type", "Idempotency-Key"),
            *("If-None-Match", "If-Range", "Range", "Last-Event-ID"),
            *("Prefer", "traceparent", "tracestate"),
        ),
        "expose_headers": (
            *("Location", "Retry-After", "ETag", "Content-Disposition", "Content-Range"),
            *("Accept-Ranges", "Allow", "WWW-Authenticate"),
            *("Idempotency-Replayed", "Preference-Applied"),
        ),
        "max_age": 600,
    }


class CrossOriginGuard:
    """ASGI middleware: a change asked for by a page of an origin that is not listed is refused.

    Browsers say where a request comes from (`Sec-Fetch-Site`, or `Origin`, which is then held
    against `Host`); who says neither is no browser.
    """

    def __init__(self, app: ASGIApp, origins: Collection[str]) -> None:
        self.app = app
        self.origins = origins

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http" and self._is_foreign_change(scope):
            refused = InputError(
                ProblemType.CROSS_ORIGIN,
                "a page of another origin asked for a change. Remedy: have its origin listed in "
                "the service's NEURALMRI_CORS_ORIGINS, or call the service from a server.",
                status=403,
            )
            answer = problem_response(refused.problem(scope["path"]))
            await answer(scope, receive, send)
            return
        await self.app(scope, receive, send)

    def _is_foreign_change(self, scope: Scope) -> bool:
        if scope["method"] in _SAFE_METHODS:
            return False
        headers = Headers(scope=scope)
        origin = headers.get("origin")
        if origin in self.origins:
            return False
        site = headers.get("sec-fetch-site")
        if site is not None:
            return site not in ("same-origin", "none")
        return origin is not None and urlsplit(origin).netloc != headers.get("host")
