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
    workers.heartbeat("old@host")
    redis.zadd("neuralmri:workers", {"old@host": 1.0})
    workers.names(30.0)
    assert redis.zrange("neuralmri:workers", 0, -1) == ["a@host"]
    assert redis.hkeys("neuralmri:worker-slots") == ["a@host"]


def test_slots_are_those_of_live_workers(redis: Redis) -> None:
    workers = LiveWorkers(redis)
    assert workers.slots(30.0) == 0
    workers.heartbeat("a@host", slots=1)
    workers.heartbeat("b@host", slots=4)
    assert workers.slots(30.0) == 5
    time.sleep(0.5)
    workers.heartbeat("b@host", slots=3)
    assert workers.slots(within_s=0.4) == 3


def test_a_finished_heartbeat_ages(redis: Redis) -> None:
    workers = LiveWorkers(redis)
    assert workers.heartbeat_finished_ago_s() is None
    workers.finished_heartbeat()
    time.sleep(0.2)
    ago_s = workers.heartbeat_finished_ago_s()
    assert ago_s is not None
    assert 0.2 <= ago_s < 2.0
