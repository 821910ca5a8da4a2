from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import psutil
import pytest
from redis import Redis
from redis.exceptions import AuthenticationError

from cli import private_redis
from cli.children import Children
from cli.ports import free_port
from cli.private_redis import redis_program, start_redis
from schemas.problem import InternalError


@pytest.fixture
def children(tmp_path: Path) -> Iterator[Children]:
    children = Children(tmp_path / "logs")
    yield children
    children.stop()


def test_it_answers_who_knows_the_password_and_nobody_else(
    children: Children, tmp_path: Path
) -> None:
    url = start_redis(tmp_path / "redis", children)
    with Redis.from_url(url) as friend:
        assert friend.set("key", "value")
        assert friend.config_get("appendonly") == {"appendonly": "yes"}
        assert friend.config_get("maxmemory-policy") == {"maxmemory-policy": "noeviction"}
        assert friend.config_get("bind") == {"bind": "127.0.0.1"}
    with (
        Redis(port=urlsplit(url).port or 0) as stranger,
        pytest.raises(AuthenticationError),
    ):
        stranger.get("key")


def test_the_password_is_in_no_process_list(children: Children, tmp_path: Path) -> None:
    password = urlsplit(start_redis(tmp_path / "redis", children)).password
    assert password
    ours = psutil.Process().children(recursive=True)
    assert ours
    assert not any(password in " ".join(process.cmdline()) for process in ours)


def test_what_it_was_told_outlives_it(tmp_path: Path) -> None:
    for turn in range(2):
        children = Children(tmp_path / "logs")
        with Redis.from_url(start_redis(tmp_path / "redis", children)) as client:
            assert client.get("key") == (b"value" if turn else None)
            client.set("key", "value")
        children.stop()


def test_a_port_that_was_taken_meanwhile_is_given_up_for_another(
    children: Children, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken = urlsplit(start_redis(tmp_path / "one", children)).port
    ports = iter([taken, free_port()])
    monkeypatch.setattr(private_redis, "free_port", lambda: next(ports))
    assert urlsplit(start_redis(tmp_path / "two", children)).port != taken
    children.check()


def test_a_server_that_cannot_start_is_told_with_a_remedy(
    children: Children, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(private_redis, "redis_program", lambda: "/bin/false")
    with pytest.raises(InternalError, match="--redis-url"):
        start_redis(tmp_path / "redis", children)


def test_the_wheels_server_is_found_without_one_on_the_path(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("PATH", "")
    assert Path(redis_program()).is_file()
