from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from schemas.api_key import KeyState, Scope
from schemas.problem import InputError
from service.keys import keyring
from service.keys.key_file import KeyFile

YEAR, WEEK = timedelta(days=365), timedelta(days=7)
BOTH = (Scope.SUBMIT, Scope.READ)


@pytest.fixture
def file(tmp_path: Path) -> KeyFile:
    return KeyFile(tmp_path)


def state(file: KeyFile, key_id: str, after: timedelta = timedelta()) -> KeyState:
    return file.keys()[key_id].state_at(datetime.now(tz=UTC) + after)


def test_a_key_lives_as_long_as_it_was_given(file: KeyFile) -> None:
    key, token = keyring.create(file, "PACS of ward 3", "ward-3", BOTH, WEEK)
    assert (key.label, key.owner, key.scopes) == ("PACS of ward 3", "ward-3", BOTH)
    assert key.id == token.key_id
    assert state(file, key.id) is KeyState.LIVE
    assert state(file, key.id, WEEK + timedelta(seconds=1)) is KeyState.EXPIRED
    forever, _ = keyring.create(file, "x", "x", BOTH, None)
    assert state(file, forever.id, 100 * YEAR) is KeyState.LIVE


def test_revoking_is_at_once_and_once(file: KeyFile) -> None:
    key, _ = keyring.create(file, "x", "x", BOTH, None)
    first = keyring.revoke(file, key.id)
    assert state(file, key.id) is KeyState.REVOKED
    assert keyring.revoke(file, key.id) == first


def test_rotating_gives_the_same_key_with_another_secret(file: KeyFile) -> None:
    old, old_token = keyring.create(file, "x", "ours", BOTH, YEAR)
    new, token = keyring.rotate(file, old.id, WEEK)
    assert (new.label, new.owner, new.scopes) == (old.label, old.owner, old.scopes)
    assert new.id != old.id
    assert token.secret != old_token.secret
    assert new.expires_at is not None
    assert new.expires_at - new.created_at == YEAR
    assert state(file, old.id, WEEK - timedelta(minutes=1)) is KeyState.LIVE
    assert state(file, old.id, WEEK) is KeyState.EXPIRED
    assert state(file, new.id, YEAR - timedelta(minutes=1)) is KeyState.LIVE
    assert file.keys()[old.id].replaced_by == new.id


def test_rotating_lengthens_no_life(file: KeyFile) -> None:
    old, _ = keyring.create(file, "x", "ours", BOTH, WEEK)
    keyring.rotate(file, old.id, YEAR)
    assert file.keys()[old.id].expires_at == old.expires_at


def test_without_overlap_the_old_key_ends_now(file: KeyFile) -> None:
    old, _ = keyring.create(file, "x", "ours", BOTH, None)
    keyring.rotate(file, old.id, timedelta())
    assert state(file, old.id) is KeyState.EXPIRED


def test_a_key_without_end_is_rotated_into_one_without_end(file: KeyFile) -> None:
    old, _ = keyring.create(file, "x", "ours", BOTH, None)
    assert keyring.rotate(file, old.id, WEEK)[0].expires_at is None


def test_only_a_live_key_is_rotated_and_once(file: KeyFile) -> None:
    revoked, _ = keyring.create(file, "x", "ours", BOTH, None)
    keyring.revoke(file, revoked.id)
    expired, _ = keyring.create(file, "x", "ours", BOTH, timedelta(microseconds=1))
    rotated, _ = keyring.create(file, "x", "ours", BOTH, None)
    new, _ = keyring.rotate(file, rotated.id, WEEK)
    for key_id, said in (
        (revoked.id, "revoked"),
        (expired.id, "expired"),
        (rotated.id, new.id),
        ("0" * 16, "keys list"),
    ):
        before = file.keys()
        with pytest.raises(InputError, match=said):
            keyring.rotate(file, key_id, WEEK)
        assert file.keys() == before
    with pytest.raises(InputError, match="no key of this id"):
        keyring.revoke(file, "../keys")
