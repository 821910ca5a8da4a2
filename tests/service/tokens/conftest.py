"""An issuer, and a service that believes its tokens and has no key."""

from collections.abc import Iterator

import pytest

from service.settings import ServiceSettings
from tests.service.callers import Serve
from tests.service.conftest import Api
from tests.service.tokens.issuer import AUDIENCE, Issuer, issuing


@pytest.fixture
def issuer() -> Iterator[Issuer]:
    with issuing() as issuer:
        yield issuer


@pytest.fixture
def trusting(settings: ServiceSettings, issuer: Issuer) -> ServiceSettings:
    quick = {
        "oidc_issuer": issuer.url,
        "oidc_audience": AUDIENCE,
        "oidc_refetch_s": 0.2,
        "oidc_leeway_s": 5.0,
    }
    return settings.model_copy(update=quick)


@pytest.fixture
def api_of_issuer(serve: Serve, trusting: ServiceSettings, api: Api) -> Api:
    """`api` first, which empties the Redis that both have."""
    return serve(trusting)
