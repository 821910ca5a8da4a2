"""Whose a job is survives whatever Redis loses."""

import json

from redis import Redis

from jobs.ending import settle
from jobs.owners import JobOwners
from jobs.queue import JobQueue
from jobs.reconcile import reconcile
from jobs.records import JobRecords
from jobs.store import JobStore
from jobs.submission import submit
from schemas.messages import JobRequest


def test_the_folder_says_whose_job_it_is(
    store: JobStore, records: JobRecords, queue: JobQueue, request_: JobRequest
) -> None:
    job = submit(store, records, queue, request_, {}, "ours")
    folder = store.folder(job.id)
    owners = JobOwners()
    assert folder.owner() == folder.request().owner == owners.of(folder) == "ours"
    (folder.path / "request.json").rename(folder.path / "elsewhere")
    assert owners.of(folder) is None, "what is erased is nobody's, though it was known"


def test_a_folder_of_before_there_were_owners_is_everybodys(
    store: JobStore, request_: JobRequest
) -> None:
    folder = store.folder(request_.job_id)
    folder.create(request_, {})
    path = folder.path / "request.json"
    document = json.loads(path.read_text())
    del document["owner"]
    path.write_text(json.dumps(document))
    assert folder.owner() == folder.request().owner == "anonymous"


def test_the_reconciler_rebuilds_ownership(
    store: JobStore, records: JobRecords, queue: JobQueue, redis: Redis, request_: JobRequest
) -> None:
    job = submit(store, records, queue, request_, {}, "ours")
    redis.flushall()
    reconcile(store, records, queue, 3600.0)
    assert [j.id for j in records.page("ours").jobs] == [job.id]
    assert records.page("anonymous").jobs == []


def test_so_do_other_ways_back_from_the_folder(
    store: JobStore, records: JobRecords, queue: JobQueue, redis: Redis, request_: JobRequest
) -> None:
    job = submit(store, records, queue, request_, {}, "ours")
    records.request_cancel(job.id)
    cancelled = records.get(job.id)
    assert cancelled is not None
    settle(store.folder(job.id), records, cancelled)
    redis.flushall()
    reconcile(store, records, queue, 3600.0)
    assert [j.state.value for j in records.page("ours").jobs] == ["cancelled"]
