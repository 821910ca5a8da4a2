"""The whole service as compose runs it, each process apart: Redis, API, and workers of one job."""

import os
import shutil
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import httpx
from redis import Redis
from redis.exceptions import RedisError

from benchmarks.member import Member
from cli.children import python_module
from cli.ports import free_port
from cli.private_redis import redis_program
from jobs.redis_client import make_redis

IMPATIENT = {
    "NEURALMRI_REDIS_TIMEOUT_S": "1",
    "NEURALMRI_LEASE_S": "3",
    "NEURALMRI_LOST_AFTER_S": "2",
    "NEURALMRI_RECONCILE_EVERY_S": "1",
    "NEURALMRI_WORKER_ALIVE_S": "5",
    "NEURALMRI_HEARTBEAT_EVERY_S": "1",
}
"""A tenth of the usual waits, so that minutes of a run show what hours of a service do."""

_STARTS_WITHIN_S = 120.0


class Stack:
    """Redis with an append-only file, one API, and `workers` workers, on free loopback ports."""

    def __init__(
        self,
        folder: Path,
        settings: Mapping[str, str],
        *,
        workers: int = 2,
        worker_app: str = "worker.app",
    ) -> None:
        self.data_dir = folder / "data"
        self.jobs_dir = self.data_dir / "jobs"
        self.log_dir = folder / "logs"
        self.redis_dir = folder / "redis"
        for made in (self.data_dir, self.log_dir, self.redis_dir):
            made.mkdir(parents=True)
        redis_port, api_port = free_port(), free_port()
        self.redis_url = f"redis://127.0.0.1:{redis_port}/0"
        self.url = f"http://127.0.0.1:{api_port}"
        env = {
            **os.environ,
            "OMP_NUM_THREADS": "1",
            **settings,
            "NEURALMRI_REDIS_URL": self.redis_url,
            "NEURALMRI_DATA_DIR": str(self.data_dir),
            "PYTHONUNBUFFERED": "1",
        }
        redis = [
            *(redis_program(), "--port", str(redis_port), "--bind", "127.0.0.1"),
            *("--dir", str(self.redis_dir), "--appendonly", "yes", "--appendfsync", "everysec"),
            *("--save", "", "--maxmemory-policy", "noeviction"),
        ]
        api = python_module(
            "uvicorn",
            *("--factory", "service.process:app_of_process", "--port", str(api_port)),
            *("--no-access-log", "--no-server-header", "--timeout-graceful-shutdown", "3"),
        )
        self.redis = Member("redis", redis, env, self.log_dir)
        self.api = Member("api", api, env, self.log_dir)
        self.workers = [
            Member(f"worker-{number}", _worker(worker_app, number), env, self.log_dir)
            for number in range(workers)
        ]

    @property
    def members(self) -> list[Member]:
        return [self.redis, self.api, *self.workers]

    def wipe_redis(self) -> None:
        """Remove its data, while it does not run."""
        shutil.rmtree(self.redis_dir)
        self.redis_dir.mkdir()

    def redis_client(self) -> Redis:
        """To be closed by who asked."""
        return make_redis(self.redis_url)

    def redis_answers(self) -> bool:
        with self.redis_client() as client:
            try:
                return bool(client.ping())
            except RedisError:
                return False

    def wait_until_ready(self) -> None:
        """Raises TimeoutError."""
        deadline = time.monotonic() + _STARTS_WITHIN_S
        while not is_ready(self.url):
            if time.monotonic() > deadline:
                raise TimeoutError(f"not ready within {_STARTS_WITHIN_S:g} s, see {self.log_dir}")
            time.sleep(0.1)


@contextmanager
def running(stack: Stack) -> Iterator[Stack]:
    """Start everything, wait until it is ready, and end what runs at the end."""
    try:
        for member in stack.members:
            member.start()
        stack.wait_until_ready()
        yield stack
    finally:
        for member in reversed(stack.members):
            member.stop()


def is_ready(url: str) -> bool:
    """Whether the service says that it takes and finishes work."""
    try:
        return httpx.get(f"{url}/readyz", timeout=5.0, trust_env=False).is_success
    except httpx.TransportError:
        return False


def _worker(app: str, number: int) -> list[str]:
    return python_module(
        "celery",
        *("--app", app, "--quiet", "worker", "--loglevel", "INFO", "--concurrency", "1"),
        *("--hostname", f"worker-{number}@benchmark", "--without-gossip", "--without-mingle"),
    )
