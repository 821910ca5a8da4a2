"""API and workers with nothing in common but Redis and a bucket."""

import hashlib
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from jobs.redis_client import make_redis
from tests.end_to_end.following import Job, follow, follow_until_fitting
from tests.end_to_end.hosts import Host, Hosts
from tests.end_to_end.test_chaos import ENDLESS, QUICK, SECONDS
from tests.redis_server import RedisServer
from tests.s3_server import BUCKET, S3Server
from tests.stores import empty_bucket, keys_of

pytestmark = [pytest.mark.integration, pytest.mark.slow]

Submit = Callable[[Hosts, dict[str, Any]], Job]


@pytest.fixture
def hosts(tmp_path: Path, s3_server: S3Server) -> Iterator[Hosts]:
    empty_bucket(s3_server.url)
    (tmp_path / "redis").mkdir()
    redis = RedisServer(tmp_path / "redis")
    redis.start()
    hosts = Hosts(redis, s3_server, tmp_path)
    yield hosts
    hosts.stop()
    redis.kill()


def is_clean(host: Host) -> bool:
    """Whether a host keeps nothing of any job."""
    files = {p.relative_to(host.data_dir).as_posix() for p in host.data_dir.rglob("*")}
    return not any(name.startswith("jobs") or name.startswith("scratch/tmp") for name in files)


def test_hosts_that_share_no_disk_do_jobs_and_keep_nothing(
    hosts: Hosts, submit: Submit, s3_server: S3Server
) -> None:
    api, worker = hosts.api(), hosts.worker("one")
    hosts.wait_until_ready()
    job_id = submit(hosts, QUICK)["id"]
    follow(hosts, job_id, "succeeded")
    manifest = httpx.get(f"{hosts.url}/v1/jobs/{job_id}/artifacts").json()
    assert {"report.json", "ED_lv_endo.stl"} <= {a["name"] for a in manifest["artifacts"]}
    for artifact in manifest["artifacts"]:
        url = f"{hosts.url}/v1/jobs/{job_id}/artifacts/{artifact['name']}"
        whole = httpx.get(url)
        assert hashlib.sha256(whole.content).hexdigest() == artifact["sha256"]
        assert whole.headers["etag"] == f'"{artifact["sha256"]}"'
        part = httpx.get(url, headers={"Range": "bytes=5-20"})
        assert (part.status_code, part.content) == (206, whole.content[5:21])
        known = {"If-None-Match": whole.headers["etag"]}
        assert httpx.get(url, headers=known).status_code == 304

    cancelled = submit(hosts, ENDLESS)["id"]
    follow_until_fitting(hosts, cancelled)
    httpx.post(f"{hosts.url}/v1/jobs/{cancelled}/cancel")
    follow(hosts, cancelled, "cancelled")

    running = submit(hosts, ENDLESS)["id"]
    follow_until_fitting(hosts, running)
    for erased in (job_id, cancelled, running):
        assert httpx.delete(f"{hosts.url}/v1/jobs/{erased}").status_code == 204
    deadline = time.monotonic() + 30.0
    while not (is_clean(api) and is_clean(worker)) or keys_of(s3_server.url):
        assert time.monotonic() < deadline, keys_of(s3_server.url)
        time.sleep(0.2)


def test_a_lost_host_and_a_lost_redis_cost_no_job(
    hosts: Hosts, submit: Submit, s3_server: S3Server
) -> None:
    hosts.api()
    first = hosts.worker("one")
    hosts.wait_until_ready()
    lost = submit(hosts, {**SECONDS, "iterations_per_level": 400})["id"]
    follow_until_fitting(hosts, lost)
    first.kill()
    hosts.running.remove(first)
    second = hosts.worker("two")
    done = follow(hosts, lost, "succeeded")
    assert done["attempt"] == 2

    waiting = submit(hosts, SECONDS)["id"]
    with make_redis(hosts.redis.url) as redis:
        redis.flushall()
    follow(hosts, waiting, "succeeded")
    listed = httpx.get(f"{hosts.url}/v1/jobs").json()["jobs"]
    assert {job["id"]: job["state"] for job in listed} == {lost: "succeeded", waiting: "succeeded"}

    keys = keys_of(s3_server.url)
    for job_id in (lost, waiting):
        own = [key for key in keys if job_id in key]
        assert len([key for key in own if key.endswith("/report.json")]) == 1, "done once"
    assert is_clean(second)


def test_a_bucket_that_is_away_is_waited_for(
    hosts: Hosts, submit: Submit, study: dict[str, Any], s3_server: S3Server
) -> None:
    hosts.api()
    hosts.worker("one")
    hosts.wait_until_ready()
    job_id = submit(hosts, SECONDS)["id"]
    follow_until_fitting(hosts, job_id)
    s3_server.stop()
    try:
        answer = httpx.post(
            f"{hosts.url}/v1/jobs/contours", json={"study": study, "options": QUICK}, timeout=60
        )
        assert answer.status_code == 503
        assert answer.json()["type"] == "urn:neuralmri:problem:store-unavailable"
        assert int(answer.headers["retry-after"]) > 0
        assert BUCKET not in answer.text
        ready = httpx.get(f"{hosts.url}/readyz", timeout=60)
        assert ready.status_code == 503
        assert "store" in [part["pointer"] for part in ready.json()["errors"]]
        time.sleep(5.0)
    finally:
        s3_server.start()
    done = follow(hosts, job_id, "succeeded")
    assert done["attempt"] == 1, hosts.logs()
