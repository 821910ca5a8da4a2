"""The live state of jobs in Redis: one method a transition, doing all of its effects at once.

A transition watches the job's hash, decides in Python by `JobState.may_become`, and writes hash,
indices and event in one MULTI; where another client was faster it decides again. Times are Redis's
own, so hosts with wrong clocks agree on leases. Fences start from the Redis clock too: they grow
even when Redis has lost everything in between.

Every method but `now` raises redis.exceptions.RedisError when Redis does not answer in time.
"""

import logging
from collections.abc import Callable, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any, cast

from redis import Redis
from redis.client import Pipeline
from redis.exceptions import RedisError, WatchError

from jobs import transitions
from jobs.admission import give_up_place
from jobs.claim import Claim, Refusal
from jobs.errors import StaleToken
from jobs.event_stream import add_event
from jobs.expiry import move_expiry
from jobs.idempotency_keys import Wholeness, move_key
from jobs.index import ANY_OWNER, batch_key, index_key, move_in_index, record_key
from jobs.line_work import move_work
from jobs.record import Record, instant
from jobs.redis_clock import now_us
from jobs.reusable import move_reusable
from jobs.runtimes import note_runtime
from jobs.tallies import tally
from schemas.job import Job, JobPage, JobState, Progress
from schemas.messages import JobRequest, Outcome

_LOGGER = logging.getLogger(__name__)

_AT_ONCE = 1000
"""Records asked for in one breath: others are answered in between."""

_Step = Callable[[Record | None, int], Record | None]


class JobRecords:
    """Jobs by id, in order, by owner and state."""

    def __init__(self, redis: Redis) -> None:
        self._redis = redis
        self.wholeness = Wholeness(redis)

    def now(self) -> datetime:
        """The time by the clock that all hosts share; by this host's where Redis does not answer.

        For what is compared with times that another host wrote.
        """
        try:
            return instant(now_us(self._redis))
        except RedisError as error:
            _LOGGER.warning("a time is by this host's clock, Redis does not answer: %s", error)
            return datetime.now(tz=UTC)

    def accepted(self, request: JobRequest) -> None:
        """A new queued job. Nothing happens where it is known already."""
        self._step(
            request.job_id,
            lambda record, now_us: record or Record.of_request(request, now_us),
        )

    def get(self, job_id: str) -> Job | None:
        record = _read(self._redis, job_id)
        return record.job() if record else None

    def traceparent(self, job_id: str) -> str | None:
        """The trace context of the request that brought the job; None where it is not known."""
        return cast(str | None, self._redis.hget(record_key(job_id), "traceparent")) or None

    def get_all(self, job_ids: Sequence[str]) -> dict[str, Job]:
        """Those of the jobs that are known, by their ids."""
        with self._redis.pipeline(transaction=False) as pipe:
            for job_id in job_ids:
                pipe.hgetall(record_key(job_id))
            found = zip(job_ids, pipe.execute(), strict=True)
        return {id_: Record.of_fields(id_, fields).job() for id_, fields in found if fields}

    def of_batch(self, batch_id: str) -> list[str]:
        """Ids of the known jobs of a batch, oldest first."""
        return cast(list[str], self._redis.zrange(batch_key(batch_id), 0, -1))

    def page(
        self,
        owner: str,
        state: JobState | None = None,
        limit: int = 50,
        cursor: str | None = None,
        batch_id: str | None = None,
    ) -> JobPage:
        """Up to `limit` jobs, newest first, those after job id `cursor`; of one batch if asked for.

        A job that is there throughout is seen exactly once over all pages, whatever comes and goes
        meanwhile; a page may be short where jobs went while it was read, and where jobs of a batch
        are in another state.
        """
        newest = f"({cursor}" if cursor else "+"
        key = batch_key(batch_id) if batch_id else index_key(owner, state)
        ids = cast(list[str], self._redis.zrevrangebylex(key, newest, "-", start=0, num=limit + 1))
        jobs = self.get_all(ids[:limit])
        return JobPage(
            jobs=[job for job in jobs.values() if state in (None, job.state)],
            next_cursor=ids[limit - 1] if len(ids) > limit else None,
        )

    def ids(self) -> list[str]:
        """Every known job, oldest first."""
        return cast(list[str], self._redis.zrange(index_key(ANY_OWNER), 0, -1))

    def states(self, job_ids: Sequence[str]) -> list[JobState | None]:
        """Where each job stands; None for an unknown one."""
        found: list[JobState | None] = []
        for start in range(0, len(job_ids), _AT_ONCE):
            with self._redis.pipeline(transaction=False) as pipe:
                for job_id in job_ids[start : start + _AT_ONCE]:
                    pipe.hget(record_key(job_id), "state")
                found += [JobState(state) if state else None for state in pipe.execute()]
        return found

    def oldest(self, state: JobState) -> str | None:
        """The id of the job that was accepted first of those in a state."""
        found = cast(list[str], self._redis.zrange(index_key(ANY_OWNER, state), 0, 0))
        return found[0] if found else None

    def is_any_held(self) -> bool:
        """Whether some worker holds a job now."""
        ids = [
            job_id
            for state in (JobState.RUNNING, JobState.CANCELLING)
            for job_id in cast(list[str], self._redis.zrange(index_key(ANY_OWNER, state), 0, -1))
        ]
        with self._redis.pipeline(transaction=False) as pipe:
            for job_id in ids:
                pipe.hget(record_key(job_id), "free_from_us")
            free_from_us = [int(found) for found in pipe.execute() if found]
        return bool(free_from_us) and max(free_from_us) > now_us(self._redis)

    def counts(self) -> dict[JobState, int]:
        """How many jobs stand in each state."""
        with self._redis.pipeline(transaction=False) as pipe:
            for state in JobState:
                pipe.zcard(index_key(ANY_OWNER, state))
            return dict(zip(JobState, pipe.execute(), strict=True))

    def claim(self, job_id: str, lease_s: float, max_attempts: int) -> Claim:
        """Ask for a job: a fencing token and a lease, or the reason why not.

        A cancelling job whose worker died is granted, so that its taker can say it is cancelled.
        """
        why: Refusal | None = None
        waited_s = 0.0

        def step(record: Record | None, now_us: int) -> Record | None:
            nonlocal why, waited_s
            why = transitions.refusal(record, now_us, max_attempts)
            if record is None or why in (Refusal.ENDED, Refusal.HELD):
                return record
            waited_s = max(0, now_us - record.free_from_us) / 1e6
            held = transitions.leased(record, now_us, lease_s)
            return held if why is Refusal.EXHAUSTED else transitions.started(held, now_us)

        record = self._step(job_id, step)
        return Claim(
            token=record.token if record and why in (None, Refusal.EXHAUSTED) else None,
            attempt=record.attempt if record else 0,
            started_at=record.started_at if record else None,
            refusal=why,
            traceparent=record.traceparent if record else None,
            waited_s=waited_s,
        )

    def renew(self, job_id: str, token: int, lease_s: float) -> bool:
        """Lengthen the lease to `lease_s` from now. False: the token is stale, stop working."""
        try:
            self._step(job_id, lambda r, now_us: transitions.renewed(r, token, now_us, lease_s))
        except StaleToken:
            return False
        return True

    def advanced(self, job_id: str, token: int, progress: Progress) -> None:
        """Say how far the job has come. Raises StaleToken."""
        self._step(job_id, lambda r, _: transitions.advanced(r, token, progress))

    def is_cancel_requested(self, job_id: str) -> bool:
        """Whether the job is being cancelled. False for an unknown one: `renew` says that."""
        state = self._redis.hget(record_key(job_id), "state")
        return state in (JobState.CANCELLING.value, JobState.CANCELLED.value)

    def keeps_frames(self, job_id: str) -> bool:
        """Whether the job was cancelled last with its finished frames to be kept."""
        return self._redis.hget(record_key(job_id), "keeps_frames") == "1"

    def request_cancel(self, job_id: str, *, keeps_frames: bool | None = False) -> JobState | None:
        """Ask the job to stop, and return where it stands then; None for an unknown job.

        keeps_frames: The frames that its worker has finished by then are its results; None: as the
        last cancellation had it.

        Without a live lease it is cancelled at once, and any token out there becomes stale; with
        one it is cancelling until its worker says it stopped. Terminal states stay.
        """
        record = self._step(
            job_id,
            lambda r, now_us: (
                r and transitions.cancel_requested(r, now_us, keeps_frames=keeps_frames)
            ),
        )
        return record.state if record else None

    def finished(self, job_id: str, token: int, outcome: Outcome) -> None:
        """Record how the job ended. Saying it twice with one token is saying it once.

        Raises StaleToken, or IllegalTransition.
        """
        self._step(job_id, lambda r, _: transitions.finished(r, token, outcome))

    def released(self, job_id: str, token: int) -> None:
        """Hand the job back unfinished, as a worker does that is told to shut down.

        It is queued again but not enqueued: that is the worker's to do, or the reconciler does it.
        A cancelling job stays so, and the reconciler ends it. Raises StaleToken.
        """
        self._step(job_id, lambda r, now_us: transitions.released(r, token, now_us))

    def reclaimed(self, job_id: str, after_s: float) -> bool:
        """Take back a job that no worker has held for `after_s`: it is queued, its tokens stale.

        True for one caller each `after_s`, who must enqueue it. Never for a cancelling job.
        """
        lost = False

        def step(record: Record | None, now_us: int) -> Record | None:
            nonlocal lost
            lost = transitions.is_lost(record, now_us, after_s)
            if record is None or record.state.is_terminal:
                return record
            if lost:
                return transitions.reclaimed(record, now_us)
            return transitions.by_the_clock(record, now_us)

        self._step(job_id, step)
        return lost

    def restore(self, request: JobRequest, outcome: Outcome | None) -> bool:
        """Make the record agree with the folder. True where there was none: enqueue it then.

        An outcome overrules whatever the record says.
        """
        was_unknown = False

        def step(record: Record | None, now_us: int) -> Record:
            nonlocal was_unknown
            was_unknown = record is None
            record = record or Record.of_request(request, now_us)
            if outcome is None or record.state is outcome.state:
                return record
            return replace(record.ended(outcome), token=record.token + 1)

        self._step(request.job_id, step)
        return was_unknown

    def forget(self, job_id: str) -> None:
        """Remove every trace of the job. Nothing happens where there is none."""
        self._step(job_id, lambda _record, _now_us: None)

    def _step(self, job_id: str, step: _Step) -> Record | None:
        """Take a step on a job's record and return what it is then; None is no record.

        `step` sees the record and the Redis clock. It is asked again where another client changed
        the record meanwhile.
        """
        key = record_key(job_id)
        with self._redis.pipeline() as pipe:
            while True:
                cast(Any, pipe).watch(key)  # redis-py gives it no types
                before = _read(pipe, job_id)
                instant_us = now_us(pipe)
                after = step(before, instant_us)
                if after == before:
                    return after
                pipe.multi()
                move_in_index(pipe, before, after)
                move_work(pipe, before, after)
                move_expiry(pipe, before, after)
                move_reusable(pipe, before, after)
                give_up_place(pipe, before, after)
                move_key(pipe, before, after)
                note_runtime(pipe, before, after, instant_us)
                add_event(pipe, before, after)
                tally(pipe, before, after)
                if after is None:
                    pipe.delete(key)
                else:
                    pipe.hset(key, mapping=cast(Any, after.fields()))
                try:
                    pipe.execute()
                except WatchError:
                    continue
                return after


def _read(redis: Redis | Pipeline, job_id: str) -> Record | None:
    fields = cast(dict[str, str], redis.hgetall(record_key(job_id)))
    return Record.of_fields(job_id, fields) if fields else None
