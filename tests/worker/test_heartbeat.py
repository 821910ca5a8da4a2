"""What a real worker says of itself."""

import os
import subprocess
import sys
import time
from functools import partial

import pytest
from redis import Redis

from jobs.live_workers import LiveWorkers
from worker.parent_death import die_with_parent
from worker.settings import WorkerSettings


@pytest.mark.integration
def test_a_worker_says_how_many_jobs_it_does_at_a_time(
    redis: Redis, settings: WorkerSettings
) -> None:
    worker = subprocess.Popen(
        [
            *(sys.executable, "-m", "celery", "--app", "worker.app", "worker"),
            *("--concurrency", "3", "--hostname", "three@test"),
            *("--without-gossip", "--without-mingle"),
        ],
        env={
            **os.environ,
            "NEURALMRI_REDIS_URL": settings.redis_url,
            "NEURALMRI_DATA_DIR": str(settings.data_dir),
        },
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        preexec_fn=partial(die_with_parent, os.getpid()),
    )
    workers = LiveWorkers(redis)
    try:
        deadline = time.monotonic() + 60.0
        while workers.names(30.0) != ["three@test"]:
            assert worker.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.1)
        assert workers.slots(30.0) == 3
    finally:
        worker.terminate()
        worker.wait(timeout=30)
