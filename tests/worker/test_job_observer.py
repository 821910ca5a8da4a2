"""What a worker tells of its progress: not too often, and of each stage how it ended."""

import json
import time
from collections.abc import Callable
from itertools import groupby
from typing import Any, cast

from redis import Redis

from jobs.event_stream import events_key
from jobs.folder import JobFolder
from jobs.records import JobRecords
from schemas.job import Progress, Stage
from worker.job_observer import JobObserver
from worker.lease import Lease


def test_hundreds_of_steps_are_few_events_and_the_last_of_each_stage(
    queued_job: Callable[[], JobFolder], records: JobRecords, redis: Redis
) -> None:
    job_id = queued_job().job_id
    token = records.claim(job_id, 30.0, 3).token
    assert token is not None
    last = {Stage.READING: 1, Stage.FITTING: 500, Stage.MESHING: 40}
    start_s = time.monotonic()
    with Lease(records, job_id, token, 30.0) as lease:
        observer = JobObserver(records, lease, lambda: False)
        for stage, steps in last.items():
            for step in range(steps + 1):
                observer.advanced(Progress(stage=stage, iteration=step))
                time.sleep(0.002)
        observer.advanced(Progress(stage=Stage.DONE, fraction=1.0))
    took_s = time.monotonic() - start_s

    entries = cast(Any, redis.xrange(events_key(job_id)))
    told = [
        Progress.model_validate(json.loads(fields["data"]))
        for _, fields in entries
        if fields["event"] == "progress"
    ]
    assert len(told) <= 4 * took_s + 2 * (len(last) + 1)
    ends = {stage: [*steps][-1].iteration for stage, steps in groupby(told, lambda p: p.stage)}
    assert ends == {**last, Stage.DONE: None}


def test_what_is_taken_up_says_nothing_of_how_fast_the_rest_will_be(
    queued_job: Callable[[], JobFolder], records: JobRecords
) -> None:
    job_id = queued_job().job_id
    token = records.claim(job_id, 30.0, 3).token
    assert token is not None

    def told() -> Progress:
        job = records.get(job_id)
        assert job is not None
        return job.progress

    with Lease(records, job_id, token, 30.0) as lease:
        observer = JobObserver(records, lease, lambda: False)
        observer.advanced(Progress(stage=Stage.FITTING, fraction=0.4, level=3))
        taken_up = told()
        assert (taken_up.fraction, taken_up.level, taken_up.eta_s) == (0.4, 3, None)
        # At once, though another word was said just now: the next frame's.
        observer.advanced(Progress(stage=Stage.FITTING, fraction=0.6, level=3))
        assert told().fraction == 0.6
        time.sleep(0.5)
        observer.advanced(Progress(stage=Stage.FITTING, fraction=0.7, level=4, iteration=0))
        # A tenth took half a second or more; by all seven tenths the rest would take 0.2 s.
        eta_s = told().eta_s
        assert eta_s is not None
        assert eta_s >= 1.4
