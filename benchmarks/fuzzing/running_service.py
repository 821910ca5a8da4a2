"""A service as it runs in earnest: a process of its own, a Redis, keys; and who ends its jobs."""

import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx

from benchmarks.fuzzing.engine import QuickEngine
from cli.children import Children, python_module
from cli.ports import free_port
from cli.private_redis import start_redis
from cli.server import api_arguments
from jobs.disk_store import DiskStore
from schemas.api_key import Scope
from service.keys import keyring
from service.keys.key_file import KeyFile
from service.settings import ServiceSettings

_READY_WITHIN_S = 60.0
_KIB = 1024

_QUIET = {
    # Long waits and silences would only make a run longer.
    "NEURALMRI_MAX_WAIT_S": "1",
    "NEURALMRI_EVENT_HEARTBEAT_S": "1",
    "NEURALMRI_WEBHOOK_MAX_ENDPOINTS": "1000",
    "NEURALMRI_MAX_QUEUED_JOBS": "100000",
    # Else nothing but 429 would be seen after the first second.
    "NEURALMRI_CALLS_PER_MINUTE": "0",
    "NEURALMRI_SUBMITS_PER_MINUTE": "0",
    "NEURALMRI_REFUSALS_PER_MINUTE": "0",
}


@dataclass(frozen=True)
class RunningService:
    """A service that answers at `url`; `key` may read and submit."""

    url: str
    key: str
    settings: ServiceSettings
    pid: int
    log: Path
    engine: QuickEngine

    @property
    def store(self) -> DiskStore:
        return DiskStore(self.settings.jobs_dir)

    @property
    def headers(self) -> dict[str, str]:
        return {"Authorization": f"Bearer {self.key}"}

    def new_key(self, owner: str, *scopes: Scope) -> str:
        """One more key, good at once."""
        file = KeyFile(self.settings.data_dir)
        return keyring.create(file, f"key of {owner}", owner, scopes, None)[1].text

    def peak_memory_bytes(self) -> int:
        """The most that the service's process has had resident so far, as the kernel counts it."""
        for line in Path(f"/proc/{self.pid}/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * _KIB
        raise RuntimeError("the kernel does not say: /proc/PID/status has no VmHWM")


@contextmanager
def running_service(
    data_dir: Path, settings: Mapping[str, str] | None = None
) -> Iterator[RunningService]:
    """Start everything in an empty folder, and stop it at the end.

    settings: environment variables of the service, beside those that make it quick.
    """
    data_dir.mkdir(parents=True, exist_ok=True)
    children = Children(data_dir / "logs")
    try:
        redis_url = start_redis(data_dir / "redis", children)
        shared = ServiceSettings(redis_url=redis_url, data_dir=data_dir.resolve())
        file = KeyFile(shared.data_dir)
        key = keyring.create(file, "fuzzing", "fuzzing", (Scope.READ, Scope.SUBMIT), None)[1].text
        port = free_port()
        process = children.start(
            "api",
            python_module("uvicorn", *api_arguments("127.0.0.1", port)),
            env={
                **{k: v for k, v in os.environ.items() if not k.startswith("NEURALMRI_")},
                "NEURALMRI_REDIS_URL": redis_url,
                "NEURALMRI_DATA_DIR": str(shared.data_dir),
                **_QUIET,
                **(settings or {}),
            },
        )
        url = f"http://127.0.0.1:{port}"
        log = data_dir / "logs" / "api.log"
        with QuickEngine(shared) as engine:
            _wait_until_ready(url, children)
            yield RunningService(url, key, shared, process.pid, log, engine)
    finally:
        children.stop()


def _wait_until_ready(url: str, children: Children) -> None:
    deadline = time.monotonic() + _READY_WITHIN_S
    with httpx.Client(timeout=5.0, trust_env=False) as client:
        while time.monotonic() < deadline:
            children.check()
            try:
                if client.get(f"{url}/readyz").is_success:
                    return
            except httpx.TransportError:
                pass  # not listening yet
            time.sleep(0.05)
    raise TimeoutError(f"the service was not ready within {_READY_WITHIN_S:g} s")
