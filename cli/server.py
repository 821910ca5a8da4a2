"""API, worker and Redis together, on this machine, for as long as a `with` block lasts."""

import fcntl
import os
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

import httpx

from cli.asking_for_keys import asks_for_keys
from cli.children import Children, python_module
from cli.outside_redis import wait_for_redis
from cli.ports import refuse_remote_host, refuse_taken_port
from cli.private_redis import start_redis
from schemas.problem import InputError, InternalError, ProblemType

_API = "service.process:app_of_process"
_PROTOCOL = "service.header_deadline:HeaderDeadline"

# On one machine nothing is slow to answer, so a lost worker is noticed in seconds.
_LOCAL_PATIENCE = {
    "NEURALMRI_LEASE_S": "10",
    "NEURALMRI_LOST_AFTER_S": "5",
    "NEURALMRI_RECONCILE_EVERY_S": "5",
}


@dataclass(frozen=True)
class ServerPlan:
    """What to run.

    workers: jobs at a time. threads: of each job's arithmetic. redis_url: None for a private one.
    ready_within_s: how long starting may take. allow_remote: whether other machines may reach it.
    """

    host: str
    port: int
    data_dir: Path
    workers: int
    threads: int = 1
    redis_url: str | None = None
    ready_within_s: float = 60.0
    allow_remote: bool = False

    @property
    def url(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}"

    @property
    def log_dir(self) -> Path:
        return self.data_dir / "logs"


@dataclass(frozen=True)
class Server:
    """A server that is ready."""

    plan: ServerPlan
    children: Children

    def check(self) -> None:
        """Raise InternalError where one of the processes has ended."""
        self.children.check()


@contextmanager
def running(plan: ServerPlan) -> Iterator[Server]:
    """Start everything, wait until it can finish work, and stop it in order at the end.

    SIGTERM ends the block by SystemExit. Raises InputError for a port or data folder that is taken
    and for a host that others reach (unless the service asks for keys or the plan allows it),
    InternalError where a process does not come up.
    """
    if not (plan.allow_remote or asks_for_keys(plan.data_dir)):
        refuse_remote_host(plan.host)
    refuse_taken_port(plan.host, plan.port)
    signal.signal(signal.SIGTERM, _exit)
    with _sole_use_of(plan.data_dir):
        children = Children(plan.log_dir)
        try:
            _start(plan, children)
            _wait_until_ready(plan, children)
            yield Server(plan, children)
        finally:
            # A second signal must not leave anything behind.
            signal.signal(signal.SIGTERM, signal.SIG_IGN)
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            children.stop()
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
            signal.signal(signal.SIGINT, signal.default_int_handler)


def _start(plan: ServerPlan, children: Children) -> None:
    """Redis first and the API last; they are stopped the other way round."""
    if plan.redis_url:
        wait_for_redis(plan.redis_url, plan.ready_within_s)
    redis_url = plan.redis_url or start_redis(plan.data_dir / "redis", children)
    env = _environment(plan, redis_url)
    children.start(
        "worker",
        python_module(
            "celery",
            *("--app", "worker.app", "--quiet", "worker", "--loglevel", "INFO"),
            *("--concurrency", str(plan.workers), "--hostname", f"worker-{os.getpid()}@%h"),
            *("--without-gossip", "--without-mingle"),
        ),
        env=env,
    )
    children.start(
        "api",
        python_module("uvicorn", *api_arguments(plan.host, plan.port)),
        env=env,
    )


def api_arguments(host: str, port: int) -> list[str]:
    """What uvicorn is told, in one place for everything that starts the API."""
    return [
        *("--factory", _API, "--host", host, "--port", str(port), "--http", _PROTOCOL),
        *("--no-access-log", "--no-server-header", "--timeout-graceful-shutdown", "3"),
    ]


def _environment(plan: ServerPlan, redis_url: str) -> dict[str, str]:
    threads = str(plan.threads)
    return {
        **_LOCAL_PATIENCE,
        **os.environ,
        "NEURALMRI_REDIS_URL": redis_url,
        "NEURALMRI_DATA_DIR": str(plan.data_dir.resolve()),
        "NEURALMRI_THREADS": threads,
        # A service that started with keys asks for them to its end, whatever becomes of their file.
        **({"NEURALMRI_REQUIRE_KEYS": "true"} if asks_for_keys(plan.data_dir) else {}),
        "PYTHONUNBUFFERED": "1",
    }


def _wait_until_ready(plan: ServerPlan, children: Children) -> None:
    deadline = time.monotonic() + plan.ready_within_s
    answer = "no answer"
    with httpx.Client(timeout=5.0, trust_env=False) as client:
        while time.monotonic() < deadline:
            children.check()
            try:
                response = client.get(f"{plan.url}/readyz")
            except httpx.TransportError as error:
                answer = str(error)
            else:
                if response.is_success:
                    return
                answer = response.text
            time.sleep(0.1)
    raise InternalError(
        ProblemType.UNAVAILABLE,
        f"the server was not ready within {plan.ready_within_s:g} s ({answer}); "
        f"see the logs in {plan.log_dir}",
    )


@contextmanager
def _sole_use_of(data_dir: Path) -> Iterator[None]:
    """Hold the data folder: two Redis servers on one append-only file would ruin it."""
    data_dir.mkdir(mode=0o700, parents=True, exist_ok=True)
    with (data_dir / "serve.lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise InputError(
                ProblemType.INVALID_REQUEST,
                f"another `neuralmri serve` uses {data_dir}; stop it, or choose another folder "
                "with --data-dir",
            ) from error
        yield


def _exit(_signal: int, _frame: FrameType | None) -> None:
    sys.exit(0)
