"""That an unknown key takes the way of a wrong one, and that uses are noted."""

from pathlib import Path

import pytest

from schemas.api_key import Scope
from service.keys import keyring
from service.keys.caller import EVERYBODY, NOBODY, Caller
from service.keys.gate import Gate, require_scope
from service.keys.refused import KeyRefused
from service.keys.token import Token

READ = (Scope.READ,)


@pytest.fixture
def gate(tmp_path: Path) -> Gate:
    return Gate.of(tmp_path, None)


def test_a_key_is_compared_whether_or_not_its_id_is_known(
    gate: Gate, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, token = keyring.create(gate.file, "x", "x", READ, None)
    compared: list[str] = []

    def opens(self: Token, secret_sha256: str) -> bool:
        compared.append(secret_sha256)
        return False

    monkeypatch.setattr(Token, "opens", opens)
    said = set()
    for tried in (token.text, Token.new().text):
        with pytest.raises(KeyRefused) as refused:
            gate.caller([tried])
        said.add((refused.value.detail, refused.value.challenge, refused.value.actor))
    assert len(compared) == 2
    assert len(said) == 1, "neither says whether there is such a key"


def test_a_stand_in_for_an_unknown_key_is_opened_by_none(gate: Gate) -> None:
    keyring.create(gate.file, "x", "x", READ, None)
    with pytest.raises(KeyRefused):
        gate.caller([f"nmri_{'0' * 16}_{'0' * 64}"])


def test_a_use_is_noted_a_refusal_is_not(gate: Gate) -> None:
    key, token = keyring.create(gate.file, "x", "x", READ, None)
    with pytest.raises(KeyRefused):
        gate.caller([token.text[:-1]])
    assert gate.used.times() == {}
    assert gate.caller([token.text]) == Caller("x", frozenset(READ), key.id)
    noted = gate.used.times()
    assert set(noted) == {key.id}
    gate.caller([token.text])
    assert gate.used.times() == noted, "to the minute is enough"


def test_a_note_that_cannot_be_made_costs_no_request(gate: Gate, tmp_path: Path) -> None:
    _, token = keyring.create(gate.file, "x", "x", READ, None)
    (tmp_path / "keys-used.json").mkdir()
    assert gate.caller([token.text]).owner == "x"


@pytest.mark.parametrize(
    ("scopes", "may"),
    [
        ({Scope.READ}, {Scope.READ}),
        ({Scope.SUBMIT}, {Scope.SUBMIT}),
        ({Scope.ADMIN}, set(Scope)),
        (set(), set()),
    ],
)
def test_what_scopes_allow(scopes: set[Scope], may: set[Scope]) -> None:
    caller = Caller("x", frozenset(scopes), "0" * 16)
    for scope in Scope:
        if scope in may:
            require_scope(caller, scope)
        else:
            with pytest.raises(KeyRefused) as refused:
                require_scope(caller, scope)
            assert refused.value.status == 403


def test_who_sees_whose_jobs() -> None:
    ours = Caller("ours", frozenset(READ))
    admin = Caller("x", frozenset({Scope.ADMIN}))
    assert [ours.sees(o) for o in ("ours", "theirs", "", "*", "our")] == [True, *[False] * 4]
    assert all(admin.sees(owner) for owner in ("ours", "theirs"))
    assert EVERYBODY.sees("anonymous")
    assert not EVERYBODY.sees("ours")
    assert not NOBODY.sees("anonymous")
