"""The door of every operation: a key or token where one is asked for, with the scope that it needs.

It is a dependency of the application, so that it comes before every other, a body's too, and no
route can be forgotten. Without it a request is NOBODY's and finds no job.
"""

from fastapi import Request
from starlette.concurrency import run_in_threadpool

from schemas.api_key import Scope
from service.keys.caller import Caller
from service.keys.gate import Gate, require_scope
from service.keys.refused import KeyRefused
from service.keys.token import PREFIX
from service.rate_limits import RateLimits
from service.tokens.check import TokenCheck

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


async def admit(request: Request) -> None:
    """Note in `request.state.caller` who calls.

    Raises KeyRefused (401, 403), InputError (429), and InternalError (503) for a token that cannot
    be checked now.
    """
    scope = scope_needed(request.method, request.scope["route"].path)
    if scope is None:
        return
    rates: RateLimits = request.app.state.rates
    try:
        caller = await _caller(request)
        require_scope(caller, scope)
    except KeyRefused as refused:
        request.state.refused_actor = refused.actor
        if refused.actor is None:
            await run_in_threadpool(rates.refuse, request)
        raise
    request.state.caller = caller
    await run_in_threadpool(rates.admit, request, caller)


async def _caller(request: Request) -> Caller:
    gate: Gate = request.app.state.gate
    tokens: TokenCheck = request.app.state.tokens
    keys = [value.strip() for value in request.headers.getlist(API_KEY_HEADER)]
    borne = _borne(request)
    if gate.takes_tokens and not keys and len(set(borne)) == 1 and not borne[0].startswith(PREFIX):
        return await tokens.caller(borne[0])
    return await run_in_threadpool(gate.caller, keys + borne)


def _borne(request: Request) -> list[str]:
    """Bearers' keys and tokens. Other schemes of Authorization are a proxy's matter, not ours."""
    found = []
    for value in request.headers.getlist("Authorization"):
        scheme, _, credentials = value.strip().partition(" ")
        if scheme.lower() == "bearer":
            found.append(credentials.strip())
    return found
