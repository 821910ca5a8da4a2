"""The HTTP API, put together."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import FastAPI

from service.access import JobAccess
from service.body_limit import BodyLimit
from service.description import DescribedApi
from service.metrics import RequestMetrics, metrics_route
from service.problems import install_problem_handlers
from service.reconciler import Reconciler
from service.request_log import RequestLog
from service.response_headers import ResponseHeaders
from service.routes import artifacts, health, jobs, request, submit_contours, submit_labels
from service.settings import ServiceSettings


def create_app(settings: ServiceSettings | None = None) -> FastAPI:
    """The ASGI application. It owns nothing that outlives it but what it stored.

    A background thread reconciles at start and from time to time; the application starts, and says
    that it is not ready, also where Redis is down. Without `settings` the environment is read.
    """
    settings = settings or ServiceSettings()
    access = JobAccess.of_settings(settings)

    @asynccontextmanager
    async def lifespan(_app: FastAPI) -> AsyncIterator[None]:
        with Reconciler(access):
            yield

    app = DescribedApi(
        title="neuralmri",
        lifespan=lifespan,
        redoc_url=None,
        # Short operation ids make readable names in generated clients.
        generate_unique_id_function=lambda route: route.name,
    )
    app.state.access = access
    install_problem_handlers(app, settings)
    for part in (submit_contours, submit_labels, jobs, request, artifacts, health):
        app.include_router(part.router)
    requests = RequestMetrics()
    app.include_router(metrics_route(requests.registry, access))
    app.add_middleware(
        BodyLimit, max_bytes=settings.max_request_bytes, within_s=settings.body_within_s
    )
    app.add_middleware(ResponseHeaders)
    app.add_middleware(requests.middleware)
    app.add_middleware(RequestLog)
    return app
