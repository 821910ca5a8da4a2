"""The line of queued jobs: which place each has in it, and when its turn will come."""

from collections.abc import Sequence
from dataclasses import dataclass

from redis import Redis

from jobs.estimate import start_in_s
from jobs.index import ANY_OWNER, index_key, line_key
from jobs.line_work import LineWork
from jobs.live_workers import LiveWorkers
from jobs.runtimes import seconds_per_work
from schemas.job import Job, JobState, Priority


@dataclass(frozen=True)
class WaitingLine:
    """Places and estimates, as Redis has them now. Every method raises RedisError.

    Places are by priority and time of submission. A worker sees another order where a job waits for
    the second time, or a batch job has its turn: estimates they are.
    """

    redis: Redis
    workers: LiveWorkers
    worker_alive_s: float

    def placed(self, jobs: Sequence[Job]) -> list[Job]:
        """The jobs, those that wait with their place and the time until they start."""
        waiting = [job for job in jobs if job.state is JobState.QUEUED]
        if not waiting:
            return list(jobs)
        before_batch, *ranks = self._ranks(waiting)
        pace = self._pace()
        work = LineWork.now(self.redis)
        known: dict[str, Job] = {}
        for job, rank in zip(waiting, ranks, strict=True):
            if rank is None:  # started since
                continue
            ahead = rank + (before_batch or 0) * (job.priority is Priority.BATCH)
            start_s = pace.start_in_s(ahead, work.mean_until(job)) if pace else None
            known[job.id] = job.model_copy(
                update={"queue_position": ahead, "estimated_start_s": start_s}
            )
        return [known.get(job.id, job) for job in jobs]

    def next_start_s(self) -> float | None:
        """Time until one of the waiting jobs starts and leaves its place; None where unknown."""
        pace = self._pace()
        return pace.start_in_s(0, LineWork.now(self.redis).mean_held()) if pace else None

    def _ranks(self, waiting: Sequence[Job]) -> list[int | None]:
        """How many interactive jobs wait, and each job's rank among those of its priority.

        No transaction, which a Redis that is out of memory refuses even where it only reads.
        """
        with self.redis.pipeline(transaction=False) as pipe:
            pipe.zcard(line_key(Priority.INTERACTIVE))
            for job in waiting:
                pipe.zrank(line_key(job.priority), job.id)
            return pipe.execute()

    def _pace(self) -> "_Pace | None":
        """How fast jobs go now; None without a worker, or before the first success."""
        of_work_s = seconds_per_work(self.redis)
        slots = self.workers.slots(self.worker_alive_s)
        if of_work_s is None or slots == 0:
            return None
        with self.redis.pipeline(transaction=False) as pipe:
            for state in (JobState.RUNNING, JobState.CANCELLING):
                pipe.zcard(index_key(ANY_OWNER, state))
            return _Pace(sum(pipe.execute()), slots, of_work_s)


@dataclass(frozen=True)
class _Pace:
    running: int
    slots: int
    of_work_s: float

    def start_in_s(self, ahead: int, mean_work: float) -> float:
        runtime_s = mean_work * self.of_work_s
        return round(start_in_s(ahead, self.running, self.slots, runtime_s), 1)
