import hashlib
import hmac
from typing import Any

import pytest

from service.keys.token import Token


def test_what_is_shown_is_what_is_parsed() -> None:
    token = Token.new()
    assert Token.parsed(token.text) == token
    assert token.opens(token.sha256)


def test_a_secret_has_256_bits_that_no_other_has() -> None:
    secrets = {Token.new().secret for _ in range(1000)}
    assert len(secrets) == 1000
    assert {len(bytes.fromhex(secret)) for secret in secrets} == {32}


def test_what_is_kept_is_the_sha256() -> None:
    token = Token("0" * 16, "ab" * 32)
    assert token.sha256 == hashlib.sha256(b"ab" * 32).hexdigest()
    assert token.secret not in token.sha256


def test_no_representation_has_the_secret() -> None:
    token = Token.new()
    assert token.secret not in f"{token!r} {token}"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "nmri_",
        f"nmri_{'0' * 16}_{'0' * 63}",
        f"nmri_{'0' * 16}_{'0' * 65}",
        f"nmri_{'0' * 16}_{'0' * 64}\n",
        f" nmri_{'0' * 16}_{'0' * 64}",
        f"nmri_{'0' * 15}_{'0' * 64}",
        f"nmri_{'0' * 16}_{'A' * 64}",
        "nmri_" + "0" * 16 + "_" + "\u0660" * 64,
        f"nmrj_{'0' * 16}_{'0' * 64}",
        "0" * 1_000_000,
    ],
)
def test_nothing_else_is_a_token(text: str) -> None:
    assert Token.parsed(text) is None


def test_a_secret_is_compared_in_constant_time(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[Any, Any]] = []
    compare = hmac.compare_digest

    def noting(a: str, b: str) -> bool:
        asked.append((a, b))
        return compare(a, b)

    monkeypatch.setattr("service.keys.token.hmac.compare_digest", noting)
    token, other = Token.new(), Token.new()
    assert token.opens(token.sha256)
    assert not other.opens(token.sha256)
    assert asked == [(token.sha256, token.sha256), (other.sha256, token.sha256)]
