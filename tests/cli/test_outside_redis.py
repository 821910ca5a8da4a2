"""Waiting for a Redis of somebody else's."""

from pathlib import Path

import pytest

from cli.outside_redis import wait_for_redis
from schemas.problem import InputError, InternalError
from tests.redis_server import RedisServer, free_port


def test_one_that_answers_is_no_wait(redis_server: RedisServer) -> None:
    wait_for_redis(redis_server.url, 0.0)


def test_one_that_comes_later_is_waited_for(tmp_path: Path) -> None:
    server = RedisServer(tmp_path)
    with pytest.raises(InternalError):
        wait_for_redis(server.url, 0.2)
    server.start()
    try:
        wait_for_redis(server.url, 30.0)
    finally:
        server.kill()


def test_one_that_does_not_answer_is_named_without_its_password() -> None:
    port = free_port()
    with pytest.raises(InternalError, match="Redis does not answer") as caught:
        wait_for_redis(f"redis://:secret@127.0.0.1:{port}/0", 0.1)
    assert f"127.0.0.1:{port}" in str(caught.value)
    assert "secret" not in str(caught.value)


def test_what_is_no_url_is_the_callers_fault() -> None:
    with pytest.raises(InputError, match="--redis-url"):
        wait_for_redis("http://127.0.0.1:6379", 0.1)
