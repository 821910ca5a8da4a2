from redis import Redis

from jobs.erased import ErasedJobs
from jobs.redis_client import make_redis
from tests.redis_server import free_port


def test_who_erased_a_job_is_remembered_for_a_while(redis: Redis) -> None:
    erased = ErasedJobs(redis)
    erased.remember("1" * 32, "ours")
    assert erased.owner_of("1" * 32) == "ours"
    assert erased.owner_of("2" * 32) is None
    (key,) = redis.keys("neuralmri:*")
    assert 6 * 24 * 3600 < int(redis.ttl(key)) <= 7 * 24 * 3600


def test_without_redis_nothing_is_known_and_nothing_fails() -> None:
    with make_redis(f"redis://127.0.0.1:{free_port()}/0", 0.5) as nothing:
        erased = ErasedJobs(nothing)
        erased.remember("1" * 32, "ours")
        assert erased.owner_of("1" * 32) is None
