import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from redis import Redis

from jobs.celery_settings import celery_settings
from jobs.queue import JobQueue
from jobs.redis_client import make_redis
from jobs.settings import JobSettings
from schemas.messages import HEARTBEAT_QUEUE, ReconstructMessage
from schemas.problem import InternalError, ProblemType
from tests.redis_server import RedisServer

MESSAGE = ReconstructMessage(job_id="0" * 32)


@pytest.fixture
def own_server(tmp_path: Path) -> Iterator[RedisServer]:
    server = RedisServer(tmp_path)
    server.start()
    yield server
    server.kill()


def test_what_is_enqueued_waits(queue: JobQueue) -> None:
    assert queue.waiting() == set()
    queue.enqueue(MESSAGE)
    queue.enqueue(ReconstructMessage(job_id="1" * 32))
    queue.enqueue(MESSAGE)
    assert queue.waiting() == {"0" * 32, "1" * 32}
    assert queue.depth() == 3


def test_the_queue_carries_a_name_and_no_data(queue: JobQueue, redis: Redis) -> None:
    queue.enqueue(MESSAGE)
    (message,) = redis.lrange("neuralmri", 0, -1)
    assert len(message) < 1500
    assert '"content-type": "application/json"' in message


@pytest.mark.parametrize("how", ["kill", "freeze"])
@pytest.mark.parametrize("warm", [True, False])
def test_a_dead_redis_is_an_error_soon(own_server: RedisServer, how: str, warm: bool) -> None:
    settings = JobSettings(redis_url=own_server.url, redis_timeout_s=1.0)
    with make_redis(own_server.url) as redis:
        queue = JobQueue(settings, redis)
        if warm:
            queue.enqueue(MESSAGE)
        getattr(own_server, how)()
        start = time.monotonic()
        with pytest.raises(InternalError) as raised:
            queue.enqueue(MESSAGE)
        assert time.monotonic() - start < 4.5
        assert (raised.value.type, raised.value.status) == (ProblemType.UNAVAILABLE, 503)


def test_a_restarted_redis_costs_no_request(own_server: RedisServer) -> None:
    with make_redis(own_server.url) as redis:
        queue = JobQueue(JobSettings(redis_url=own_server.url), redis)
        queue.enqueue(MESSAGE)
        own_server.kill()
        own_server.start()
        queue.enqueue(MESSAGE)
        assert queue.depth() == 1


def test_no_message_comes_back_while_its_task_may_run() -> None:
    settings = JobSettings(soft_time_limit_s=100, hard_time_limit_s=7200)
    celery = celery_settings(settings)
    visible_again_s = celery["broker_transport_options"]["visibility_timeout"]
    assert visible_again_s > celery["task_time_limit"] > celery["task_soft_time_limit"]
    assert celery["task_acks_late"] is celery["task_reject_on_worker_lost"] is True
    assert celery["accept_content"] == ["json"]
    assert celery["result_backend"] is None


def test_limits_out_of_order_are_refused() -> None:
    with pytest.raises(ValueError, match="below hard_time_limit_s"):
        JobSettings(soft_time_limit_s=100, hard_time_limit_s=100)


def test_heartbeats_wait_apart_from_jobs_and_do_not_pile_up(queue: JobQueue, redis: Redis) -> None:
    for _ in range(3):
        queue.ask_for_heartbeat()
    assert redis.llen(HEARTBEAT_QUEUE) == 1
    assert (queue.depth(), queue.waiting()) == (0, set())
