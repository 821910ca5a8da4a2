"""A batch from one request to one archive, done by a real worker."""

import hashlib
import io
import time
import zipfile
from typing import Any

import httpx
import pytest

from tests.end_to_end.serve_process import ServeProcess

pytestmark = [pytest.mark.integration, pytest.mark.slow]

FAST = {"preset": "fast", "formats": ["stl"]}
ENDLESS = {"iterations_per_level": 5000, "levels": 8}


def look(server: ServeProcess, batch: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = httpx.get(f"{server.url}{batch['links']['self']}", timeout=30).json()
    return found


def test_one_bad_one_cancelled_one_fetched(server: ServeProcess, study: dict[str, Any]) -> None:
    body = {
        "studies": [
            {"name": "good", "study": study},
            {"name": "bad", "study": {**study, "units": "um"}},
            {"name": "endless", "study": study, "options": ENDLESS},
        ],
        "options": FAST,
    }
    key = {"Idempotency-Key": "a cohort of three"}
    posted = httpx.post(f"{server.url}/v1/batches/contours", json=body, headers=key, timeout=60)
    assert posted.status_code == 202, posted.text
    batch = posted.json()
    good, bad, endless = batch["studies"]
    assert (bad["state"], bad["error"]["pointer"]) == ("refused", "/studies/1/study/units")

    deadline = time.monotonic() + 240
    while [m["state"] for m in look(server, batch)["studies"]][::2] != ["succeeded", "running"]:
        assert time.monotonic() < deadline, look(server, batch)
        time.sleep(0.1)
    assert 0.5 <= look(server, batch)["fraction"] < 1.0
    archive = f"{server.url}{batch['links']['archive']}"
    assert httpx.get(archive, timeout=30).status_code == 409

    cancelled = httpx.post(f"{server.url}{batch['links']['cancel']}", timeout=30)
    assert cancelled.status_code == 202
    while not look(server, batch)["ended"]:
        assert time.monotonic() < deadline, look(server, batch)
        time.sleep(0.1)
    ended = look(server, batch)
    assert [m["state"] for m in ended["studies"]] == ["succeeded", "refused", "cancelled"]
    assert ended["fraction"] == 1.0
    again = httpx.post(f"{server.url}/v1/batches/contours", json=body, headers=key, timeout=60)
    assert again.headers["idempotency-replayed"] == "true"
    assert again.json() == ended

    manifest = httpx.get(f"{server.url}{good['links']['artifacts']}", timeout=30).json()
    with zipfile.ZipFile(io.BytesIO(httpx.get(archive, timeout=60).content)) as whole:
        assert whole.testzip() is None
        for artifact in manifest["artifacts"]:
            content = whole.read(f"good/{artifact['name']}")
            assert len(content) == artifact["bytes"]
            assert hashlib.sha256(content).hexdigest() == artifact["sha256"]
        assert len(whole.namelist()) == len(manifest["artifacts"]) + 2

    for _ in range(2):
        gone = httpx.delete(f"{server.url}{batch['links']['self']}", timeout=30)
        assert gone.status_code == 204
    for member in (good, endless):
        assert httpx.get(f"{server.url}{member['links']['self']}", timeout=30).status_code == 404
