"""The Redis of the compose file, started with its own command: what it refuses, what it keeps."""

import os
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
import yaml
from redis import Redis
from redis.backoff import NoBackoff
from redis.exceptions import AuthenticationError, ResponseError
from redis.exceptions import ConnectionError as RedisConnectionError
from redis.retry import Retry

from tests.redis_server import free_port, redis_binary

COMPOSE = Path(__file__).parents[2] / "docker" / "compose.yaml"
SERVICE = yaml.safe_load(COMPOSE.read_text())["services"]["redis"]
PASSWORD = "0123456789abcdef"

pytestmark = pytest.mark.integration


@dataclass
class Server:
    process: "subprocess.Popen[bytes]"
    port: int
    environment: dict[str, str]

    def client(self, password: str | None = PASSWORD) -> Redis:
        return Redis(
            port=self.port,
            password=password,
            socket_timeout=5,
            decode_responses=True,
            retry=Retry(NoBackoff(), 0),
        )


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    folder = tmp_path_factory.mktemp("redis")
    port = free_port()
    shell, flag, script = SERVICE["command"]
    # Compose writes $ as $$; the folder and the port are the only things that differ here.
    script = script.replace("$$", "$").replace(
        "dir /data", f"dir {folder}\nport {port}\nbind 127.0.0.1"
    )
    environment = {
        "PATH": f"{Path(redis_binary()).parent}{os.pathsep}{os.environ['PATH']}",
        "REDISCLI_AUTH": PASSWORD,
    }
    process = subprocess.Popen(
        [shell, flag, script],
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    running = Server(process, port, environment)
    try:
        _wait_until_it_answers(running)
        yield running
    finally:
        process.kill()
        process.wait(timeout=10)


def _wait_until_it_answers(server: Server) -> None:
    deadline = time.monotonic() + 20.0
    while True:
        try:
            with server.client() as client:
                client.ping()
            return
        except RedisConnectionError:
            assert server.process.poll() is None, "redis-server ended"
            assert time.monotonic() < deadline, "redis-server did not answer within 20 s"
            time.sleep(0.05)


def test_refuses_who_has_no_password(server: Server) -> None:
    with server.client(password=None) as client, pytest.raises(AuthenticationError):
        client.ping()


def test_refuses_a_wrong_password(server: Server) -> None:
    with (
        server.client(password="wrong") as client,
        pytest.raises((AuthenticationError, ResponseError)),
    ):
        client.ping()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("appendonly", "yes"),
        ("appendfsync", "everysec"),
        ("maxmemory-policy", "noeviction"),
        ("save", ""),
    ],
)
def test_keeps_what_it_is_given(server: Server, name: str, value: str) -> None:
    with server.client() as client:
        assert client.config_get(name) == {name: value}


def test_memory_bound_is_below_the_containers(server: Server) -> None:
    """Half at most: writing the log anew forks, and the copy may need as much again."""
    assert SERVICE["mem_limit"] == "1g"
    with server.client() as client:
        assert 0 < int(client.config_get("maxmemory")["maxmemory"]) <= 2**29


def test_password_is_in_no_argument_list(server: Server) -> None:
    arguments = Path(f"/proc/{server.process.pid}/cmdline").read_bytes()
    assert b"redis-server" in arguments  # the shell has become the server: signals reach it
    assert PASSWORD.encode() not in arguments


def test_health_check_passes(server: Server) -> None:
    kind, command = SERVICE["healthcheck"]["test"]
    assert kind == "CMD-SHELL"
    command = command.replace("redis-cli", f"redis-cli -p {server.port}")
    environment = server.environment
    passed = subprocess.run(["sh", "-c", command], env=environment, timeout=20, check=False)
    assert passed.returncode == 0
    environment = environment | {"REDISCLI_AUTH": "wrong"}
    failed = subprocess.run(
        ["sh", "-c", command], env=environment, stderr=subprocess.DEVNULL, timeout=20, check=False
    )
    assert failed.returncode != 0
