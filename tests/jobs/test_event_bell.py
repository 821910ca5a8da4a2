"""Whoever waits for a job is woken by what happens to it, and by nothing else."""

import asyncio
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from jobs import event_bell
from jobs.event_bell import EventBell
from jobs.event_stream import EVENT_CHANNEL
from jobs.redis_client import make_async_redis, make_redis
from tests.redis_server import RedisServer


@pytest.fixture
def own_redis(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[RedisServer]:
    monkeypatch.setattr(event_bell, "_CHECK_EVERY_S", 0.3)
    server = RedisServer(tmp_path)
    server.start()
    yield server
    server.kill()


@asynccontextmanager
async def listening(server: RedisServer) -> AsyncIterator[EventBell]:
    """A bell that is subscribed."""
    async with make_async_redis(server.url, 0.5) as redis, EventBell(redis) as bell:
        with bell.waiter("first") as waiter:
            assert await waiter.wait(5.0), "whoever waits is rung for each new connection"
        yield bell


def publish(server: RedisServer, job_id: str) -> None:
    with make_redis(server.url) as redis:
        redis.publish(EVENT_CHANNEL, job_id)


def test_it_rings_for_the_job_and_keeps_a_ring_that_nobody_waited_for(
    own_redis: RedisServer,
) -> None:
    async def listen() -> None:
        async with listening(own_redis) as bell:
            with bell.waiter("a") as one, bell.waiter("a") as two, bell.waiter("b") as other:
                publish(own_redis, "a")
                assert not await other.wait(0.2)
                start = time.monotonic()
                assert await one.wait(5.0)
                assert await two.wait(5.0)
                assert time.monotonic() - start < 0.1
                assert not await one.wait(0.1)

    asyncio.run(listen())


@pytest.mark.parametrize("how", ["kill", "freeze"])
def test_when_redis_is_back_everybody_is_rung(own_redis: RedisServer, how: str) -> None:
    async def listen() -> None:
        async with listening(own_redis) as bell:
            with bell.waiter("a") as waiter:
                getattr(own_redis, how)()
                assert not await waiter.wait(1.5)
                if how == "kill":
                    own_redis.start()
                else:
                    own_redis.thaw()
                assert await waiter.wait(10.0)
                publish(own_redis, "a")
                assert await waiter.wait(5.0)

    asyncio.run(listen())


def test_silence_is_no_outage_and_one_connection_serves_all(own_redis: RedisServer) -> None:
    async def listen() -> None:
        async with listening(own_redis) as bell:
            with make_redis(own_redis.url) as redis:
                before = redis.client_list()
                waiters = [bell.waiter(str(number)) for number in range(100)]
                entered = [waiter.__enter__() for waiter in waiters]
                await asyncio.sleep(2.0)
                assert [c["id"] for c in redis.client_list()] == [c["id"] for c in before]
                assert not any([await waiter.wait(0.0) for waiter in entered])
                for waiter in waiters:
                    waiter.__exit__(None, None, None)
                assert not bell._waiters

    asyncio.run(listen())


def test_it_leaves_no_task_and_no_connection(own_redis: RedisServer) -> None:
    async def listen() -> set[str]:
        async with listening(own_redis):
            pass
        return {task.get_name() for task in asyncio.all_tasks()}

    assert "event-bell" not in asyncio.run(listen())
    with make_redis(own_redis.url) as redis:
        assert len(redis.client_list()) == 1
