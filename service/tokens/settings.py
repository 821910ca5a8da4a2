"""Settings of bearer tokens, from the environment: NEURALMRI_OIDC_ISSUER and so on."""

import ipaddress
from typing import Self
from urllib.parse import urlsplit

from pydantic import Field, field_validator, model_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

from schemas.api_key import Scope

ALGORITHMS = (
    *("RS256", "RS384", "RS512", "PS256", "PS384", "PS512"),
    *("ES256", "ES384", "ES512", "EdDSA"),
)
"""Signatures by a private key. `none` has no signature, and HS* a secret that we would share."""


class OidcSettings(BaseSettings):
    """Whose tokens are believed, and how far. Without an issuer none is."""

    model_config = SettingsConfigDict(env_prefix="NEURALMRI_", frozen=True, extra="ignore")

    oidc_issuer: str | None = Field(
        default=None, description="Whose tokens are believed: their `iss`, exactly."
    )
    oidc_audience: str | None = Field(
        default=None, description="What a token has to be for: one of its `aud`."
    )
    oidc_jwks_url: str | None = Field(
        default=None, description="The issuer's keys; unset, as its own description says."
    )
    oidc_owner_claim: str = Field(
        default="sub", min_length=1, description="The claim that says whose jobs a token works on."
    )
    oidc_scope_claim: str = Field(
        default="scope", min_length=1, description="The claim that lists what a token may do."
    )
    oidc_scopes: str = Field(
        default="read=read submit=submit admin=admin",
        description="What the issuer's words mean, as WORD=SCOPE, separated by spaces.",
    )
    oidc_algorithms: str = Field(
        default="RS256 PS256 ES256", description="Signatures that count, separated by spaces."
    )
    oidc_leeway_s: float = Field(
        default=30.0, ge=0.0, le=300.0, description="How far the issuer's clock may be off."
    )
    oidc_timeout_s: float = Field(
        default=5.0, gt=0.0, le=60.0, description="How long the issuer may take to answer."
    )
    oidc_refresh_s: float = Field(
        default=300.0, gt=0.0, le=86400.0, description="How often its keys are asked for anew."
    )
    oidc_refetch_s: float = Field(
        default=10.0,
        gt=0.0,
        le=3600.0,
        description="Time between two questions at the least: after a failure, or for a new key.",
    )
    oidc_stale_s: float = Field(
        default=86400.0,
        gt=0.0,
        description="How long keys go on counting while the issuer does not answer.",
    )

    @field_validator("oidc_issuer", "oidc_jwks_url")
    @classmethod
    def _is_private_on_its_way(cls, url: str | None) -> str | None:
        return url if url is None else confidential(url)

    @field_validator("oidc_algorithms")
    @classmethod
    def _are_signatures(cls, text: str) -> str:
        unfit = [name for name in text.split() if name not in ALGORITHMS]
        if unfit or not text.split():
            raise ValueError(f"name some of {', '.join(ALGORITHMS)}, separated by spaces")
        return text

    @field_validator("oidc_scopes")
    @classmethod
    def _are_scopes(cls, text: str) -> str:
        parse_scopes(text)
        return text

    @model_validator(mode="after")
    def _name_issuer_and_audience(self) -> Self:
        if (self.oidc_issuer is None) is not (self.oidc_audience is None):
            raise ValueError("oidc_issuer and oidc_audience need each other: set both, or neither")
        if self.oidc_jwks_url is not None and self.oidc_issuer is None:
            raise ValueError("oidc_jwks_url needs oidc_issuer: set it, too")
        return self

    @property
    def takes_tokens(self) -> bool:
        return self.oidc_issuer is not None


def confidential(url: str) -> str:
    """`url`, where nobody on the way can put other keys into the answer.

    Raises ValueError for anything but https, or http to this very machine.
    """
    parts = urlsplit(url)
    is_local = parts.scheme == "http" and _is_loopback(parts.hostname or "")
    if not parts.hostname or not (parts.scheme == "https" or is_local):
        raise ValueError(f"{url!r} is not https; http will do on the loopback alone")
    if parts.username or parts.fragment:
        raise ValueError(f"the URL at {parts.hostname} has credentials or a fragment; leave it out")
    return url


def parse_scopes(text: str) -> dict[str, Scope]:
    """Our scopes by the issuer's words for them. Raises ValueError."""
    found: dict[str, Scope] = {}
    for pair in text.split():
        word, _, scope = pair.rpartition("=")
        if not word or scope not in set(Scope):
            raise ValueError(f"{pair!r} is not WORD=SCOPE, where SCOPE is {', '.join(Scope)}")
        found[word] = Scope(scope)
    if not found:
        raise ValueError("no word means anything; write WORD=SCOPE")
    return found


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
