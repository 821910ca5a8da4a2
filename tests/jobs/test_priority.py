"""In which order a free worker takes jobs, asked of the very consumer that a worker runs."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from celery import Celery
from redis import Redis

from jobs.celery_settings import celery_settings
from jobs.queue import JobQueue
from jobs.reconcile import reconcile
from jobs.records import JobRecords
from jobs.settings import JobSettings
from jobs.store import JobStore
from jobs.submission import submit
from schemas.job import Priority
from schemas.messages import JobRequest, ReconstructMessage

Take = Callable[[], str]


@pytest.fixture
def take(settings: JobSettings) -> Iterator[Take]:
    """Take one message as a worker with one free place does, finish it, and say whose it was."""
    app = Celery("test-consumer", set_as_current=False)
    app.conf.update(celery_settings(settings))
    with app.connection_for_read() as connection, connection.channel() as channel:
        taken: list[str] = []

        def receive(message: Any) -> None:
            taken.append(message.headers["id"])
            message.ack()

        consumer = app.amqp.TaskConsumer(channel, on_message=receive)
        consumer.qos(prefetch_count=1)
        consumer.consume()

        def one() -> str:
            before = len(taken)
            while len(taken) == before:
                connection.drain_events(timeout=5.0)
            assert len(taken) == before + 1
            return taken[-1]

        yield one


def sent(queue: JobQueue, store: JobStore, priority: Priority) -> str:
    job_id = store.new_id()
    queue.enqueue(ReconstructMessage(job_id=job_id, priority=priority))
    return job_id


def test_interactive_goes_before_batch_and_the_older_before_the_younger(
    queue: JobQueue, store: JobStore, take: Take
) -> None:
    order = [Priority.BATCH, Priority.INTERACTIVE] * 4
    ids = [sent(queue, store, priority) for priority in order]
    assert queue.waiting() == set(ids)
    assert queue.depth() == len(ids)
    assert [take() for _ in ids] == ids[1::2] + ids[0::2]
    assert queue.depth() == 0


def test_what_comes_late_is_asked_for_anew_each_time(
    queue: JobQueue, store: JobStore, take: Take
) -> None:
    """Between two batch jobs an interactive one slips in; nothing was fetched ahead."""
    batch = [sent(queue, store, Priority.BATCH) for _ in range(2)]
    assert take() == batch[0]
    late = sent(queue, store, Priority.INTERACTIVE)
    assert [take(), take()] == [late, batch[1]]


def test_a_batch_job_has_its_turn_while_interactive_ones_keep_coming(
    queue: JobQueue, store: JobStore, take: Take
) -> None:
    every_s = 0.3
    batch = [sent(queue, store, Priority.BATCH) for _ in range(3)]
    first_sent_s = time.monotonic()
    for _ in range(3):
        sent(queue, store, Priority.INTERACTIVE)
    assert not queue.give_batch_turn(every_s), "none has waited so long"
    turns: list[float] = []
    served: list[str] = []
    while len(turns) < len(batch):
        sent(queue, store, Priority.INTERACTIVE)
        queue.give_batch_turn(every_s)
        served.append(take())
        if served[-1] in batch:
            turns.append(time.monotonic())
        assert time.monotonic() - first_sent_s < 10.0
        time.sleep(0.02)
    assert [job_id for job_id in served if job_id in batch] == batch
    gaps_s = [b - a for a, b in zip([first_sent_s, *turns], turns, strict=False)]
    assert min(gaps_s) > 0.8 * every_s
    assert max(gaps_s) < every_s + 0.2
    assert queue.depth() == 3 + len(turns), "each turn costs the interactive jobs one place"


def test_a_turn_is_one_whoever_gives_it(queue: JobQueue, store: JobStore) -> None:
    for _ in range(3):
        sent(queue, store, Priority.BATCH)
    time.sleep(0.02)
    assert [queue.give_batch_turn(0.01), queue.give_batch_turn(3600.0)] == [True, False]
    time.sleep(0.02)
    assert not queue.give_batch_turn(3600.0)
    assert queue.give_batch_turn(0.01)


def test_a_job_keeps_its_priority_when_redis_is_lost(
    queue: JobQueue,
    store: JobStore,
    records: JobRecords,
    redis: Redis,
    make_request: Callable[[], JobRequest],
    take: Take,
) -> None:
    requests = [
        make_request().model_copy(update={"priority": priority})
        for priority in (Priority.BATCH, Priority.INTERACTIVE)
    ]
    for request in requests:
        submit(store, records, queue, request, {})
    redis.flushall()
    reconcile(store, records, queue, 3600.0)
    found = [records.get(request.job_id) for request in requests]
    assert [job and job.priority for job in found] == [Priority.BATCH, Priority.INTERACTIVE]
    assert [take(), take()] == [requests[1].job_id, requests[0].job_id]


def test_a_message_of_before_there_were_priorities_is_interactive() -> None:
    assert ReconstructMessage.model_validate({"job_id": "0" * 32}).priority is Priority.INTERACTIVE
