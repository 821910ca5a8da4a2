import time

import pytest
from redis import Redis
from redis.exceptions import RedisError

from jobs.redis_client import make_redis
from service.webhooks.dispatch_lock import DispatchLock
from tests.redis_server import free_port


def test_one_holds_it_until_it_lets_go(redis: Redis) -> None:
    one, other = DispatchLock(redis, 5.0), DispatchLock(redis, 5.0)
    assert one.hold()
    assert one.hold(), "keeping it"
    assert (one.is_held, other.hold(), other.is_held) == (True, False, False)
    other.release()
    assert not other.hold(), "it was not the other's to release"
    one.release()
    assert not one.is_held
    assert other.hold()


def test_it_runs_out_where_its_holder_died(redis: Redis) -> None:
    one, other = DispatchLock(redis, 0.1), DispatchLock(redis, 5.0)
    assert one.hold()
    time.sleep(0.15)
    assert not one.is_held, "by its own clock"
    assert other.hold()
    assert not one.hold()


def test_a_redis_that_lost_it_gives_it_to_who_asks_first(redis: Redis) -> None:
    one, other = DispatchLock(redis, 5.0), DispatchLock(redis, 5.0)
    assert one.hold()
    redis.flushall()
    assert other.hold()
    assert not one.hold()
    assert not one.is_held


def test_without_redis_nobody_holds_it() -> None:
    with make_redis(f"redis://127.0.0.1:{free_port()}/0", 0.5) as nowhere:
        lock = DispatchLock(nowhere, 5.0)
        with pytest.raises(RedisError):
            lock.hold()
        assert not lock.is_held


def test_a_holder_that_died_before_the_clock_went_back_holds_it_no_longer_than_ever(
    redis: Redis,
) -> None:
    one, other = DispatchLock(redis, 0.3), DispatchLock(redis, 0.3)
    assert one.hold()
    redis.expire("neuralmri:webhooks:dispatcher", 86400)
    assert not other.hold(), "its holder may live"
    assert one.hold()
    redis.expire("neuralmri:webhooks:dispatcher", 86400)
    assert not other.hold()
    time.sleep(0.4)
    assert other.hold()
