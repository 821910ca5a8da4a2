"""Laws of the token buckets, on a real Redis."""

import time
from concurrent.futures import ThreadPoolExecutor

import pytest
from redis import Redis

from jobs.rate_bucket import Bucket, Policy, take


def test_a_full_bucket_gives_its_quota_at_once_and_no_more(redis: Redis) -> None:
    bucket = Bucket(Policy("calls", 7), "a")
    left = [take(redis, [bucket]).levels[0].remaining for _ in range(7)]
    assert left == [6, 5, 4, 3, 2, 1, 0]
    refused = take(redis, [bucket])
    assert refused.wait_s == pytest.approx(60 / 7, abs=1.0)
    assert refused.levels[0].full_in_s == pytest.approx(60.0, abs=1.0)
    assert take(redis, [Bucket(Policy("calls", 7), "b")]).wait_s == 0.0


def test_many_at_once_get_no_more_than_the_quota(redis: Redis) -> None:
    bucket = Bucket(Policy("calls", 50, window_s=3600), "a")
    with ThreadPoolExecutor(8) as threads:
        waits = list(threads.map(lambda _: take(redis, [bucket]).wait_s, range(200)))
    assert sum(wait == 0.0 for wait in waits) == 50


def test_all_buckets_give_or_none(redis: Redis) -> None:
    wide, narrow = Bucket(Policy("calls", 10), "a"), Bucket(Policy("submits", 1), "a")
    assert take(redis, [wide, narrow]).wait_s == 0.0
    refused = take(redis, [wide, narrow])
    assert refused.wait_s > 0.0
    assert [level.remaining for level in refused.levels] == [9, 0]
    assert take(redis, [wide]).levels[0].remaining == 8


def test_tokens_come_back_with_time_and_an_idle_bucket_is_forgotten(redis: Redis) -> None:
    bucket = Bucket(Policy("calls", 4, window_s=1), "a")
    for _ in range(4):
        assert take(redis, [bucket]).wait_s == 0.0
    refused = take(redis, [bucket])
    assert 0.0 < refused.wait_s <= 0.25
    time.sleep(refused.wait_s + 0.01)
    assert take(redis, [bucket]).wait_s == 0.0
    time.sleep(1.2)
    assert redis.keys("neuralmri:rate:*") == []
