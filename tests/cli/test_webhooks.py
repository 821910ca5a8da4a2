"""`neuralmri webhooks ...` as typed, against a real service and a real receiver."""

import json
import os
import subprocess
import sysconfig
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from service.settings import ServiceSettings
from tests.redis_server import RedisServer
from tests.service.conftest import Api, serving
from tests.service.webhooks.conftest import TO_LOOPBACK
from tests.service.webhooks.receiver import Receiver, receiving

NEURALMRI = str(Path(sysconfig.get_path("scripts")) / "neuralmri")


@pytest.fixture
def api(tmp_path: Path) -> Iterator[Api]:
    """Over a Redis of its own: the dispatcher's lock may be held in the shared one."""
    redis = RedisServer(tmp_path)
    redis.start()
    try:
        settings = ServiceSettings(redis_url=redis.url, data_dir=tmp_path / "data", **TO_LOOPBACK)
        with serving(settings) as api:
            yield api
    finally:
        redis.kill()


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with receiving() as receiver:
        yield receiver


def webhooks(api: Api, *arguments: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [NEURALMRI, "webhooks", *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
        env={**os.environ, "NEURALMRI_URL": str(api.client.base_url)},
    )


def told(api: Api, *arguments: str) -> Any:
    done = webhooks(api, *arguments, "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_an_endpoint_from_its_registration_to_its_removal(api: Api, receiver: Receiver) -> None:
    added = webhooks(api, "add", receiver.url, "--event", "job.failed", "--label", "the ward")
    assert added.returncode == 0, added.stderr
    secret = added.stdout.strip()
    assert secret.startswith("whsec_")
    assert "shown only now" in added.stderr
    assert secret not in added.stderr
    (webhook,) = told(api, "list")["webhooks"]
    assert (webhook["events"], webhook["label"]) == (["job.failed"], "the ward")
    listed = webhooks(api, "list").stdout
    assert listed.split()[:2] == [webhook["id"], receiver.url]
    assert secret not in listed

    api.client.post(f"/v1/webhooks/{webhook['id']}/test")
    while told(api, "deliveries", webhook["id"])["deliveries"][0]["state"] == "pending":
        time.sleep(0.1)
    line = webhooks(api, "deliveries", webhook["id"], "--limit", "1").stdout.split()
    assert line[1:] == ["delivered", "webhook.test", "-", "204"]
    assert told(api, "replay", webhook["id"], line[0])["id"] == line[0]
    assert webhooks(api, "replay", webhook["id"], line[0]).stdout.split()[0] == line[0]

    assert webhooks(api, "remove", webhook["id"]).stdout == "removed\n"
    assert told(api, "list") == {"webhooks": []}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("add", "ftp://example.org"), "not to be sent to"),
        (("add", ""), "url"),
        (("remove", "nothing"), "no such webhook"),
        (("deliveries", "nothing"), "no such webhook"),
        (("replay", "nothing", "msg_1"), "no such webhook"),
    ],
)
def test_wrong_use_ends_with_2_and_says_why(
    api: Api, arguments: tuple[str, ...], said: str
) -> None:
    done = webhooks(api, *arguments)
    assert done.returncode == 2, done.stderr
    assert said in " ".join(done.stderr.split())
