"""A server that asks for keys, from outside: other machines, other tenants, and its logs."""

import json
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.end_to_end.serve_process import NEURALMRI, ServeProcess

pytestmark = [pytest.mark.integration, pytest.mark.slow]

SUBJECT = "Doe.Jane-1961"


def neuralmri(*arguments: str | Path, **env: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [NEURALMRI, *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
        env={**os.environ, **env},
    )


def new_key(data_dir: Path, owner: str, *scopes: str) -> str:
    chosen = [word for scope in scopes or ("read", "submit") for word in ("--scope", scope)]
    made = neuralmri("keys", "create", "--data-dir", data_dir, "--label", owner, *chosen)
    assert made.returncode == 0, made.stderr
    return made.stdout.strip()


@pytest.fixture
def keyed_server(tmp_path: Path) -> Iterator[tuple[ServeProcess, str]]:
    """It listens where other machines reach it, which without a key it refuses to."""
    token = new_key(tmp_path / "data", "ours")
    server = ServeProcess(tmp_path / "data", "--host", "0.0.0.0")  # noqa: S104
    server.url = f"http://0.0.0.0:{server.port}"
    server.wait_until_ready()
    yield server, token
    server.stop()


def test_one_subject_through_a_server_that_asks_for_keys(
    keyed_server: tuple[ServeProcess, str], study: dict[str, Any], tmp_path: Path
) -> None:
    server, token = keyed_server
    url = f"http://127.0.0.1:{server.port}"
    file = tmp_path / "study.json"
    options = {"preset": "fast", "formats": ["stl"]}
    file.write_text(json.dumps({"study": {**study, "subject_id": SUBJECT}, "options": options}))

    refused = neuralmri("submit", file, "--server", url)
    assert refused.returncode == 2
    assert "asks for an API key" in refused.stderr

    command = ("submit", file, "--server", url, "--wait", "--json", "--out", tmp_path / "out")
    done = neuralmri(*command, NEURALMRI_API_KEY=token)
    assert done.returncode == 0, done.stderr
    job = json.loads(done.stdout)
    assert job["state"] == "succeeded"
    assert (tmp_path / "out" / "ED_lv_endo.stl").exists()

    watched = neuralmri("watch", job["id"], "--server", url, "--json", NEURALMRI_API_KEY=token)
    assert watched.returncode == 0, watched.stderr
    assert json.loads(watched.stdout.splitlines()[-1])["data"]["state"] == "succeeded"

    address = f"{url}/v1/jobs/{job['id']}"
    refused = neuralmri("rerun", address, "--retry-within", "0")
    assert (refused.returncode, "asks for an API key" in refused.stderr) == (2, True)
    again = neuralmri("rerun", address, "--api-key", token)
    assert again.returncode == 0, again.stdout + again.stderr

    stranger = {"X-API-Key": new_key(server.data_dir, "theirs")}
    assert httpx.get(f"{url}/v1/jobs/{job['id']}", headers=stranger).status_code == 404
    mine = {"X-API-Key": token}
    metrics = httpx.get(f"{url}/metrics", headers=mine).text
    assert httpx.delete(f"{url}/v1/jobs/{job['id']}", headers=mine).status_code == 204
    code, error = server.stop()
    assert code == 0, error

    left = [path for path in server.data_dir.rglob("*") if path.is_file()]
    assert {"api.log", "worker.log", "redis.log", "done.jsonl"} <= {path.name for path in left}
    words = b"\n".join([metrics.encode(), *(path.read_bytes() for path in left)])
    assert job["id"].encode() in words
    assert SUBJECT.encode() not in words
    assert token[-64:].encode() not in words
    assert b'"erase"' in (server.data_dir / "audit" / "done.jsonl").read_bytes()


def test_what_may_be_reached_by_others_asks_for_keys_to_its_end(
    keyed_server: tuple[ServeProcess, str],
) -> None:
    server, _ = keyed_server
    (server.data_dir / "keys.json").unlink()
    assert httpx.get(f"http://127.0.0.1:{server.port}/v1/jobs").status_code == 401


def test_keys_that_are_not_asked_for_open_no_address_to_others(tmp_path: Path) -> None:
    new_key(tmp_path / "data", "ours")
    refused = neuralmri(
        *("serve", "--host", "192.0.2.1", "--data-dir", tmp_path / "data"),
        NEURALMRI_REQUIRE_KEYS="false",
    )
    assert refused.returncode == 2
    assert "--allow-remote" in refused.stderr
