"""An API and workers as on hosts of their own: each has a data folder, and they share Redis and a
bucket.
"""

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import httpx
import psutil

from tests.redis_server import RedisServer, free_port
from tests.s3_server import BUCKET, S3Server
from worker.parent_death import die_with_parent

ROOT = Path(__file__).parents[2]
_READY_WITHIN_S = 90.0


@dataclass
class Host:
    """One process and its children on a host."""

    process: "subprocess.Popen[bytes]"
    data_dir: Path
    log: Path

    def child(self) -> psutil.Process:
        """The process of a worker that computes."""
        (found,) = psutil.Process(self.process.pid).children()
        return found

    def kill(self) -> None:
        """The host loses its power."""
        family = psutil.Process(self.process.pid).children(recursive=True)
        self.process.kill()
        for process in family:
            process.kill()
        self.process.wait(timeout=20)


@dataclass
class Hosts:
    """What they share, and those that run."""

    redis: RedisServer
    s3: S3Server
    folder: Path
    running: list[Host] = field(default_factory=list)
    port: int = field(default_factory=free_port)

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def api(self) -> Host:
        return self._start(
            "api",
            *("uvicorn", "--factory", "service.process:app_of_process"),
            *("--port", str(self.port), "--no-access-log"),
        )

    def worker(self, name: str) -> Host:
        return self._start(
            name,
            *("celery", "--app", "worker.app", "worker", "--concurrency", "1"),
            *("--hostname", f"worker@{name}"),
        )

    def wait_until_ready(self) -> None:
        deadline = time.monotonic() + _READY_WITHIN_S
        while not self._is_ready():
            assert time.monotonic() < deadline, self.logs()
            assert all(host.process.poll() is None for host in self.running), self.logs()
            time.sleep(0.2)

    def logs(self) -> str:
        return "\n".join(f"{h.log.name}:\n{h.log.read_text()[-3000:]}" for h in self.running)

    def stop(self) -> None:
        for host in self.running:
            if host.process.poll() is None:
                host.process.send_signal(signal.SIGTERM)
        for host in self.running:
            try:
                host.process.wait(timeout=30)
            except subprocess.TimeoutExpired:
                host.kill()

    def _start(self, name: str, module: str, *arguments: str) -> Host:
        data_dir = self.folder / name
        log = self.folder / f"{name}.log"
        environment = {
            **os.environ,
            **self.s3.environment,
            "NEURALMRI_REDIS_URL": self.redis.url,
            "NEURALMRI_STORE_URL": f"s3://{BUCKET}/hosts",
            "NEURALMRI_DATA_DIR": str(data_dir),
            "NEURALMRI_LEASE_S": "2",
            "NEURALMRI_LOST_AFTER_S": "1",
            "NEURALMRI_RECONCILE_EVERY_S": "1",
            "NEURALMRI_WORKER_ALIVE_S": "10",
            "NEURALMRI_HEARTBEAT_EVERY_S": "1",
            "NEURALMRI_MAX_ATTEMPTS": "20",
        }
        with log.open("wb") as file:
            process = subprocess.Popen(
                [sys.executable, "-m", module, *arguments],
                env=environment,
                cwd=ROOT,
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=file,
                preexec_fn=partial(die_with_parent, os.getpid(), signal.SIGTERM),
            )
        host = Host(process, data_dir, log)
        self.running.append(host)
        return host

    def _is_ready(self) -> bool:
        try:
            return httpx.get(f"{self.url}/readyz", timeout=10).is_success
        except httpx.TransportError:
            return False
