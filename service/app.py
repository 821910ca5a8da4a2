"""The HTTP API, put together."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import Depends, FastAPI
from starlette.middleware.cors import CORSMiddleware

from jobs import spans
from service.access import JobAccess
from service.audit import Audited
from service.audit_log import AuditLog
from service.body_limit import BodyLimit
from service.cross_origin import CrossOriginGuard, cors
from service.description import DescribedApi
from service.door import admit
from service.framing import OneFraming
from service.header_deadline import HEADERS_WITHIN_S
from service.keys.gate import Gate
from service.listening import Listening
from service.metrics import RequestMetrics, metrics_route
from service.problems import install_problem_handlers
from service.rate_headers import RateHeaders
from service.rate_limits import RateLimits
from service.reconciler import Reconciler
from service.request_log import RequestLog
from service.response_headers import ResponseHeaders
from service.routes import (
    archives,
    artifacts,
    batches,
    events,
    health,
    jobs,
    options,
    pages,
    request,
    restart,
    submit_batch,
    submit_contours,
    submit_files,
    submit_labels,
    validate,
    webhook_deliveries,
    webhooks,
)
from service.settings import ServiceSettings
from service.tokens.check import TokenCheck
from service.tokens.keys_at_hand import KeysAtHand
from service.webhooks.desk import WebhookDesk
from service.webhooks.dispatcher import Dispatcher


def create_app(settings: ServiceSettings | None = None) -> FastAPI:
    """The ASGI application. It owns nothing that outlives it but what it stored.

    Background threads reconcile, at start and from time to time, and deliver webhooks; the
    application starts, and says that it is not ready, also where Redis is down. Without `settings`
    the environment is read.
    """
    settings = settings or ServiceSettings()
    access = JobAccess.of_settings(settings)
    desk = WebhookDesk.of_settings(settings)
    issuer_keys = KeysAtHand(settings)

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[dict[str, float]]:
        async with Listening(settings) as app.state.listening, issuer_keys:
            try:
                with Reconciler(access), Dispatcher(access, desk):
                    yield {HEADERS_WITHIN_S: settings.headers_within_s}
            finally:
                await asyncio.to_thread(spans.stop)

    app = DescribedApi(
        title="neuralmri",
        lifespan=lifespan,
        docs_url=None,  # the pages are routes of our own, see service/routes/pages.py
        redoc_url=None,
        # A redirect would lead to whatever Host the request named.
        redirect_slashes=False,
        # Short operation ids make readable names in generated clients.
        generate_unique_id_function=lambda route: route.name,
        dependencies=[Depends(admit)],
    )
    app.state.access = access
    app.state.gate = Gate.of(
        settings.data_dir, settings.require_keys, takes_tokens=settings.takes_tokens
    )
    app.state.issuer_keys = issuer_keys
    app.state.tokens = TokenCheck(settings, issuer_keys)
    app.state.rates = RateLimits(settings)
    app.state.webhooks = desk
    install_problem_handlers(app, settings)
    for part in (
        submit_contours,
        submit_labels,
        submit_files,
        submit_batch,
        validate,
        options,
        jobs,
        batches,
        events,
        request,
        restart,
        artifacts,
        archives,
        webhooks,
        webhook_deliveries,
        health,
        pages,
    ):
        app.include_router(part.router)
    requests = RequestMetrics()
    app.include_router(metrics_route(requests.registry, access, desk, issuer_keys))
    app.add_middleware(Audited, log=AuditLog.of_settings(settings))
    app.add_middleware(
        BodyLimit, max_bytes=settings.max_request_bytes, within_s=settings.body_within_s
    )
    app.add_middleware(RateHeaders)
    app.add_middleware(CrossOriginGuard, origins=settings.origins)
    if settings.origins:
        app.add_middleware(CORSMiddleware, **cors(settings.origins))
    app.add_middleware(OneFraming)
    app.add_middleware(ResponseHeaders)
    app.add_middleware(requests.middleware)
    app.add_middleware(RequestLog)
    return app
