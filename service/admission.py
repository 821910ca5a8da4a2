"""The door of every operation: a key where keys are asked for, with the scope that it needs.

It is a dependency of the application, so that it comes before every other, a body's too, and no
route can be forgotten. Without it a request is NOBODY's and finds no job.
"""

from fastapi import Request

from schemas.api_key import Scope
from service.keys.gate import Gate, KeyRefused, require_scope
from service.rate_limits import RateLimits

API_KEY_HEADER = "X-API-Key"

OPEN_PATHS = ("/healthz", "/readyz")
"""What load balancers and container engines ask. It says nothing about jobs."""

_PAGES = ("/docs", "/redoc", "/openapi.json")
"""What browsers open, which send no key. They describe the calls and say nothing about jobs."""

_READING = ("GET", "HEAD", "OPTIONS")


def scope_needed(method: str, path: str) -> Scope | None:
    """The scope of an operation by the template of its path; None for an open one."""
    if path in OPEN_PATHS or path.startswith(_PAGES):
        return None
    return Scope.READ if method.upper() in _READING else Scope.SUBMIT


def admit(request: Request) -> None:
    """Note in `request.state.caller` who calls. Raises KeyRefused (401, 403), InputError (429)."""
    scope = scope_needed(request.method, request.scope["route"].path)
    if scope is None:
        return
    gate: Gate = request.app.state.gate
    rates: RateLimits = request.app.state.rates
    try:
        caller = gate.caller(_presented(request))
        require_scope(caller, scope)
    except KeyRefused as refused:
        request.state.refused_key_id = refused.key_id
        if refused.key_id is None:
            rates.refuse(request)
        raise
    request.state.caller = caller
    rates.admit(request, caller)


def _presented(request: Request) -> list[str]:
    """Keys in the headers. Other schemes of Authorization are a proxy's matter, not ours."""
    keys = [value.strip() for value in request.headers.getlist(API_KEY_HEADER)]
    for value in request.headers.getlist("Authorization"):
        scheme, _, credentials = value.strip().partition(" ")
        if scheme.lower() == "bearer":
            keys.append(credentials.strip())
    return keys
