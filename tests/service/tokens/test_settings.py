import re
from typing import Any

import pytest
from pydantic import ValidationError

from schemas.api_key import Scope
from schemas.problem import InputError
from service.keys.desk import KeyDesk
from service.settings import ServiceSettings
from service.tokens.opaque_id import OWNER_PREFIX, opaque_id

GOOD = {"oidc_issuer": "https://id.example.org", "oidc_audience": "x"}


@pytest.mark.parametrize(
    "given",
    [
        {},
        GOOD,
        {**GOOD, "oidc_issuer": "http://127.0.0.1:8080/realms/x"},
        {**GOOD, "oidc_issuer": "http://[::1]:8080"},
        {**GOOD, "oidc_jwks_url": "https://keys.example.org/jwks.json"},
        {**GOOD, "oidc_algorithms": "EdDSA"},
        {**GOOD, "oidc_scopes": "api://x/read=read api://x/read=submit a=b=admin"},
    ],
)
def test_what_is_taken(given: dict[str, Any]) -> None:
    assert ServiceSettings(**given).takes_tokens is bool(given)


@pytest.mark.parametrize(
    "given",
    [
        {"oidc_issuer": "https://id.example.org"},
        {"oidc_audience": "x"},
        {"oidc_jwks_url": "https://id.example.org/keys"},
        {**GOOD, "oidc_issuer": "http://id.example.org"},
        {**GOOD, "oidc_issuer": "http://127.0.0.1.example.org"},
        {**GOOD, "oidc_issuer": "https://user:secret@id.example.org"},
        {**GOOD, "oidc_issuer": "file:///etc/passwd"},
        {**GOOD, "oidc_issuer": "id.example.org"},
        {**GOOD, "oidc_jwks_url": "http://id.example.org/keys"},
        {**GOOD, "oidc_algorithms": "none"},
        {**GOOD, "oidc_algorithms": "RS256 HS256"},
        {**GOOD, "oidc_algorithms": ""},
        {**GOOD, "oidc_scopes": ""},
        {**GOOD, "oidc_scopes": "read"},
        {**GOOD, "oidc_scopes": "read=write"},
        {**GOOD, "oidc_scopes": "=read"},
    ],
)
def test_what_is_refused(given: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        ServiceSettings(**given)


def test_an_opaque_id_is_stable_and_each_its_own() -> None:
    """It is in job folders: another one would lose everybody's jobs."""
    known = "oidc-e950dbe175a38980122039f4db018fab"
    assert opaque_id("https://id.example.org", "sub", "42") == known
    others = {
        opaque_id("https://id.example.org", "sub", "43"),
        opaque_id("https://id.example.org", "org", "42"),
        opaque_id("https://id.example.com", "sub", "42"),
    }
    assert len(others) == 3
    assert all(re.fullmatch(OWNER_PREFIX + "[0-9a-f]{32}", one) for one in others)


def test_no_key_is_made_for_an_owner_of_tokens(settings: ServiceSettings) -> None:
    with pytest.raises(InputError, match="oidc-"):
        KeyDesk(settings).create("x", opaque_id("i", "sub", "1"), (Scope.READ,), None)
