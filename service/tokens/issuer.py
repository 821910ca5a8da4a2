"""Asking an issuer for its keys, over HTTP."""

import asyncio
import json
from typing import Any
from urllib.parse import urlsplit

import httpx

from service.tokens.key_set import KeySet
from service.tokens.settings import OidcSettings, confidential

_DISCOVERY = "/.well-known/openid-configuration"
_MAX_BYTES = 1 << 20


class IssuerSilent(Exception):  # noqa: N818 - reads as what happened
    """The issuer gave no keys; the message says why, and holds nothing that it sent."""


async def keys_of(settings: OidcSettings) -> KeySet:
    """The issuer's keys as they are now. Raises IssuerSilent."""
    try:
        async with (
            asyncio.timeout(settings.oidc_timeout_s),
            httpx.AsyncClient(
                timeout=settings.oidc_timeout_s, trust_env=_is_remote(settings)
            ) as http,
        ):
            url = settings.oidc_jwks_url or await _discovered(http, settings.oidc_issuer or "")
            return KeySet.of_document(await _document(http, url))
    except TimeoutError as error:
        raise IssuerSilent(f"no answer within {settings.oidc_timeout_s:g} s") from error
    except httpx.HTTPStatusError as error:
        raise IssuerSilent(f"it answered {error.response.status_code}") from error
    except (httpx.HTTPError, httpx.InvalidURL) as error:
        raise IssuerSilent(type(error).__name__) from error
    except (ValueError, RecursionError) as error:
        raise IssuerSilent(f"its answer is of no use ({type(error).__name__}: {error})") from error


async def _discovered(http: httpx.AsyncClient, issuer: str) -> str:
    """Where the keys are, by OpenID Connect Discovery 1.0. Raises ValueError for a wrong document.

    The document has to name the very issuer, or somebody else's keys would count for ours.
    """
    document = await _document(http, issuer.rstrip("/") + _DISCOVERY)
    if not isinstance(document, dict) or document.get("issuer") != issuer:
        raise ValueError("the description at this issuer's address is of another one")
    if not isinstance(url := document.get("jwks_uri"), str):
        raise ValueError("the description names no jwks_uri")
    return confidential(url)


async def _document(http: httpx.AsyncClient, url: str) -> Any:
    content = b""
    async with http.stream("GET", url, headers={"Accept": "application/json"}) as response:
        response.raise_for_status()  # redirects too: they would lead to whom nobody named
        async for chunk in response.aiter_bytes():
            content += chunk
            if len(content) > _MAX_BYTES:
                raise ValueError(f"it is longer than {_MAX_BYTES} bytes")
    return json.loads(content)


def _is_remote(settings: OidcSettings) -> bool:
    """Proxies of the environment are for the outside."""
    return urlsplit(settings.oidc_jwks_url or settings.oidc_issuer or "").scheme == "https"
