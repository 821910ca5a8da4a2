"""The route of a request as its template, `/v1/jobs/{job_id}`: never what a caller wrote."""

from starlette.types import Scope

_METHODS = {"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"}


def method_and_route(scope: Scope) -> tuple[str, str]:
    """Of which there are few: what a client invents is `other` and `unmatched`."""
    route = getattr(scope.get("route"), "path", "unmatched")
    method = scope["method"] if scope["method"] in _METHODS else "other"
    return method, route
