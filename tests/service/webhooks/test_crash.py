"""Messages while processes are killed and Redis forgets: none is lost, and ids tell repetitions."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import httpx
import pytest
from redis import Redis

from jobs.records import JobRecords
from jobs.store import JobStore
from schemas.job import JobState
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.redis_server import free_port
from tests.service.jobs_done import finish
from tests.service.webhooks.conftest import TO_LOOPBACK
from tests.service.webhooks.receiver import Receiver
from worker.parent_death import die_with_parent

pytestmark = pytest.mark.integration


class ServiceProcess:
    """A service in a process of its own, so that it can be killed."""

    def __init__(self, settings: ServiceSettings) -> None:
        self.port = free_port()
        told = {
            "redis_url": settings.redis_url,
            "data_dir": settings.data_dir,
            "reconcile_every_s": 1,
            **TO_LOOPBACK,
            "webhook_timeout_s": 30,
        }
        self.process = subprocess.Popen(
            [
                *(sys.executable, "-m", "uvicorn", "--factory", "service.app:create_app"),
                *("--host", "127.0.0.1", "--port", str(self.port), "--log-level", "error"),
            ],
            env={
                **os.environ,
                **{f"NEURALMRI_{name.upper()}": str(value) for name, value in told.items()},
            },
            preexec_fn=partial(die_with_parent, os.getpid()),
        )
        self.client = httpx.Client(base_url=f"http://127.0.0.1:{self.port}", timeout=20.0)
        deadline = time.monotonic() + 30.0
        while not self._answers():
            assert self.process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.05)

    def kill(self) -> None:
        """An end without a word."""
        self.client.close()
        self.process.kill()
        self.process.wait()

    def post(self, path: str, body: Any) -> dict[str, Any]:
        answer = self.client.post(path, json=body)
        assert answer.is_success, answer.text
        posted: dict[str, Any] = answer.json()
        return posted

    def delivery(self, webhook_id: str) -> dict[str, Any]:
        (found,) = self.client.get(f"/v1/webhooks/{webhook_id}/deliveries").json()["deliveries"]
        return dict(found)

    def _answers(self) -> bool:
        try:
            return self.client.get("/healthz").is_success
        except httpx.TransportError:
            return False


@pytest.fixture
def start(settings: ServiceSettings) -> Iterator[Callable[[], ServiceProcess]]:
    started: list[ServiceProcess] = []

    def run() -> ServiceProcess:
        started.append(ServiceProcess(settings))
        return started[-1]

    yield run
    for service in started:
        service.kill()


def test_an_end_that_no_service_saw_is_told_after_the_restart(
    start: Callable[[], ServiceProcess],
    store: JobStore,
    records: JobRecords,
    redis: Redis,
    receiver: Receiver,
) -> None:
    """The crash is between outcome and message; Redis loses everything on top."""
    service = start()
    hook = service.post("/v1/webhooks", {"url": receiver.url})
    job = service.post("/v1/jobs/contours", CONTOUR_REQUEST)
    service.kill()
    finish(store, records, job["id"], JobState.SUCCEEDED)
    redis.flushall()
    again = start()
    (message,) = receiver.wait_for(1, within_s=20.0)
    time.sleep(1.0)
    assert len(receiver.received) == 1
    delivery = again.delivery(hook["id"])
    assert (delivery["id"], delivery["job_id"]) == (message.id, job["id"])
    assert delivery["state"] == "delivered"


def test_a_message_whose_answer_was_not_noted_comes_again_under_its_id(
    start: Callable[[], ServiceProcess],
    store: JobStore,
    records: JobRecords,
    redis: Redis,
    receiver: Receiver,
) -> None:
    """The crash is between the receiver's having it and our writing that down."""
    service = start()
    hook = service.post("/v1/webhooks", {"url": receiver.url})
    job = service.post("/v1/jobs/contours", CONTOUR_REQUEST)
    killed = []

    def kill_once() -> None:
        if not killed:
            killed.append(service.process.pid)
            service.kill()

    receiver.before_reply = kill_once
    finish(store, records, job["id"], JobState.FAILED)
    receiver.wait_for(1)
    again = start()
    first, second = receiver.wait_for(2, within_s=30.0)
    assert (first.id, first.body) == (second.id, second.body)
    time.sleep(1.0)
    assert len(receiver.received) == 2
    assert again.delivery(hook["id"])["state"] == "delivered"
