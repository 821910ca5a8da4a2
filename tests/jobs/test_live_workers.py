import time

from redis import Redis

from jobs.live_workers import LiveWorkers


def test_a_worker_is_alive_while_it_says_so(redis: Redis) -> None:
    workers = LiveWorkers(redis)
    assert workers.names(30.0) == []
    workers.heartbeat("b@host")
    workers.heartbeat("a@host")
    assert workers.names(30.0) == ["a@host", "b@host"]
    time.sleep(0.5)
    workers.heartbeat("b@host")
    assert workers.names(within_s=0.4) == ["b@host"]


def test_a_worker_that_fell_silent_long_ago_is_forgotten(redis: Redis) -> None:
    workers = LiveWorkers(redis)
    workers.heartbeat("a@host")
    (key,) = redis.keys("*")
    redis.zadd(key, {"old@host": 1.0})
    workers.names(30.0)
    assert redis.zrange(key, 0, -1) == ["a@host"]


def test_a_finished_heartbeat_ages(redis: Redis) -> None:
    workers = LiveWorkers(redis)
    assert workers.heartbeat_finished_ago_s() is None
    workers.finished_heartbeat()
    time.sleep(0.2)
    ago_s = workers.heartbeat_finished_ago_s()
    assert ago_s is not None
    assert 0.2 <= ago_s < 2.0
