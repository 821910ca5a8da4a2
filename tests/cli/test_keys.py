"""`neuralmri keys` as an operator types it."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

from cli.asking_for_keys import asks_for_keys
from service.keys.gate import Gate
from tests.cli.test_main import NEURALMRI

CREATE = ("create", "--label", "pacs", "--scope", "submit", "--scope", "read")


@pytest.fixture
def data_dir(tmp_path: Path) -> Path:
    return tmp_path / "data"


def keys(data_dir: Path, *arguments: str, code: int = 0) -> "subprocess.CompletedProcess[str]":
    ended = subprocess.run(
        [NEURALMRI, "keys", *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
        env={**os.environ, "NEURALMRI_DATA_DIR": str(data_dir), "COLUMNS": "200"},
    )
    assert ended.returncode == code, ended.stdout + ended.stderr
    assert "Traceback" not in ended.stderr
    return ended


def told(data_dir: Path, *arguments: str) -> Any:
    return json.loads(keys(data_dir, *arguments, "--json").stdout)


def test_the_secret_is_shown_once_and_alone_on_standard_output(data_dir: Path) -> None:
    token = keys(data_dir, *CREATE, "--expires", "90d").stdout.strip()
    assert Gate.of(data_dir, None).caller([token]).owner == "pacs"
    listed = keys(data_dir, "list").stdout
    assert "'pacs' of pacs: submit, read, until 20" in listed
    assert "live, last used 20" in listed
    assert token[-64:] not in listed + json.dumps(told(data_dir, "list"))


def test_a_key_from_its_making_to_its_end(data_dir: Path) -> None:
    made = told(data_dir, *CREATE, "--owner", "hospital")
    old = made["key"]["id"]
    assert made["key"]["owner"] == "hospital"
    new = told(data_dir, "rotate", old, "--overlap", "1h")
    assert new["token"] != made["token"]
    assert [k["state"] for k in told(data_dir, "list")["keys"]] == ["live", "live"]
    assert told(data_dir, "revoke", old)["state"] == "revoked"
    states = {k["key"]["id"]: k["state"] for k in told(data_dir, "list")["keys"]}
    assert states == {old: "revoked", new["key"]["id"]: "live"}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("create", "--label", "ward 3", "--scope", "read"), "--owner"),
        (("create", "--label", "x", "--scope", "write"), "--scope"),
        (("create", "--label", "x"), "--scope"),
        ((*CREATE, "--expires", "soon"), "90d"),
        (("revoke", "0" * 16), "keys list"),
        (("rotate", "../keys"), "keys list"),
    ],
)
def test_wrong_use_ends_with_2_and_a_remedy(
    data_dir: Path, arguments: tuple[str, ...], said: str
) -> None:
    assert said in keys(data_dir, *arguments, code=2).stderr
    assert told(data_dir, "list") == {"keys": []}


def test_a_service_with_a_key_asks_for_it_unless_it_is_told_not_to(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert not asks_for_keys(data_dir)
    keys(data_dir, *CREATE)
    assert asks_for_keys(data_dir)
    monkeypatch.setenv("NEURALMRI_REQUIRE_KEYS", "false")
    assert not asks_for_keys(data_dir)


def test_an_issuer_is_reason_enough_to_ask(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """So a server that trusts one may listen beyond the loopback without a key."""
    monkeypatch.setenv("NEURALMRI_OIDC_ISSUER", "https://id.example.org")
    monkeypatch.setenv("NEURALMRI_OIDC_AUDIENCE", "neuralmri")
    assert asks_for_keys(tmp_path)
