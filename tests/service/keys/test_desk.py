import json
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest

from schemas.api_key import KeyState, Scope
from schemas.problem import InputError
from service.keys.__main__ import main
from service.keys.desk import KeyDesk
from service.settings import ServiceSettings


@pytest.fixture
def desk(tmp_path: Path) -> KeyDesk:
    return KeyDesk(ServiceSettings(data_dir=tmp_path))


def audit(data_dir: Path) -> list[dict[str, Any]]:
    lines = (data_dir / "audit" / "done.jsonl").read_text().splitlines()
    return [json.loads(line) for line in lines]


def test_every_step_is_in_the_audit_log_without_the_secret(desk: KeyDesk, tmp_path: Path) -> None:
    old = desk.create("the ward's", "ward", (Scope.READ,), None)
    new = desk.rotate(old.key.id, timedelta(days=1))
    desk.revoke(new.key.id)
    assert [(e["actor"], e["owner"], e["action"], e["key"]) for e in audit(tmp_path)] == [
        ("operator", "ward", "key-created", old.key.id),
        ("operator", "ward", "key-rotated", old.key.id),
        ("operator", "ward", "key-created", new.key.id),
        ("operator", "ward", "key-revoked", new.key.id),
    ]
    text = (tmp_path / "audit" / "done.jsonl").read_text()
    assert old.token[-64:] not in text
    assert new.token[-64:] not in text


def test_a_label_that_is_a_name_is_the_owner(desk: KeyDesk) -> None:
    assert desk.create("ward-3", None, (Scope.READ,), None).key.owner == "ward-3"
    assert [listed.state for listed in desk.listed()] == [KeyState.LIVE]


@pytest.mark.parametrize(
    ("label", "owner", "scopes", "option"),
    [
        ("ward 3", None, (Scope.READ,), "--owner"),
        ("x", "*", (Scope.READ,), "--owner"),
        ("x", "a:b", (Scope.READ,), "--owner"),
        ("x", "a" * 65, (Scope.READ,), "--owner"),
        ("", "x", (Scope.READ,), "--label"),
        ("a\nb", "x", (Scope.READ,), "--label"),
        ("x", "x", (), "--scope"),
    ],
)
def test_what_makes_no_key(
    desk: KeyDesk, label: str, owner: str | None, scopes: tuple[Scope, ...], option: str
) -> None:
    with pytest.raises(InputError, match=option):
        desk.create(label, owner, scopes, None)
    assert desk.listed() == []


def test_the_same_without_the_command_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("NEURALMRI_DATA_DIR", str(tmp_path))

    def said(*arguments: str, code: int = 0) -> Any:
        assert main([*arguments]) == code
        return json.loads(capsys.readouterr().out)

    made = said(
        *("create", "--label", "x", "--scope", "read", "--scope", "submit", "--expires", "1d")
    )
    assert made["key"]["scopes"] == ["read", "submit"]
    new = said("rotate", made["key"]["id"])
    assert said("revoke", new["key"]["id"])["state"] == "revoked"
    assert [k["state"] for k in said("list")["keys"]] == ["live", "revoked"]
    assert "Remedy" in said("revoke", "0" * 16, code=2)["detail"]
