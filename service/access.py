"""What every route works with: the jobs, found by the id in a URL."""

from dataclasses import dataclass, replace
from typing import Annotated

from fastapi import Depends, Request
from redis import Redis

from jobs.admission import Admission
from jobs.batch_store import BatchStore
from jobs.erased import ErasedJobs
from jobs.errors import JobGone
from jobs.folder import JobFolder
from jobs.live_workers import LiveWorkers
from jobs.open_store import open_store
from jobs.owners import JobOwners
from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.redis_client import make_redis
from jobs.store import JobStore, is_job_id
from jobs.tallies import Tallies
from jobs.waiting_line import WaitingLine
from schemas.batch import BatchRecord
from schemas.job import Job
from schemas.problem import InputError, ProblemType
from service.batches.book import BatchBook
from service.keys.caller import EVERYBODY, NOBODY, Caller
from service.settings import ServiceSettings


@dataclass(frozen=True)
class JobAccess:
    """Folders, records, queue and workers, as one service process knows them.

    caller: for whom jobs are looked up; any other's are not there.
    """

    settings: ServiceSettings
    store: JobStore
    records: JobRecords
    queue: JobQueue
    workers: LiveWorkers
    tallies: Tallies
    line: WaitingLine
    admission: Admission
    owners: JobOwners
    erased: ErasedJobs
    batches: BatchBook
    redis: Redis
    caller: Caller = NOBODY

    @classmethod
    def of_settings(cls, settings: ServiceSettings) -> "JobAccess":
        redis = make_redis(settings.redis_url, settings.redis_timeout_s)
        workers = LiveWorkers(redis)
        return cls(
            settings=settings,
            store=open_store(settings),
            records=JobRecords(redis),
            queue=JobQueue(settings, redis),
            workers=workers,
            tallies=Tallies(redis),
            line=WaitingLine(redis, workers, settings.worker_alive_s),
            admission=Admission(redis, settings.max_queued_jobs, settings.max_jobs_per_owner),
            owners=JobOwners(),
            erased=ErasedJobs(redis),
            batches=BatchBook(BatchStore(settings.data_dir / "batches"), redis),
            redis=redis,
        )

    def live_workers(self) -> list[str]:
        """Names of the workers that take jobs now. Raises RedisError."""
        return self.workers.names(self.settings.worker_alive_s)

    def is_work_done(self) -> bool:
        """Whether a worker holds a job, or has finished a heartbeat of late. Raises RedisError.

        A heartbeat waits where every worker is at a job; then the leases show that they work.
        """
        ago_s = self.workers.heartbeat_finished_ago_s()
        is_fresh = ago_s is not None and ago_s <= self.settings.heartbeat_within_s
        return is_fresh or self.records.is_any_held()

    def folder(self, job_id: str) -> JobFolder:
        """The folder of a job of the caller's. Raises InputError (not found, 404)."""
        if is_job_id(job_id):
            folder = self.store.folder(job_id)
            owner = self.owners.of(folder)
            if owner is not None and self.caller.sees(owner):
                return folder
        raise no_such_job()

    def erasable(self, job_id: str) -> JobFolder:
        """The folder of a job that the caller may erase, or has erased before.

        Raises InputError (not found, 404). Where no keys are asked for, any id will do: there is
        no owner to keep it from, and no Redis is needed to remember what was erased.
        """
        if is_job_id(job_id):
            folder = self.store.folder(job_id)
            if not folder.exists() and self.has_erased(job_id):
                return folder
        return self.folder(job_id)

    def has_erased(self, job_id: str) -> bool:
        """Whether the caller may be told that a job, or a batch, was erased by its owner."""
        if self.caller == EVERYBODY or self.caller.is_admin:
            return True
        owner = self.erased.owner_of(job_id)
        return owner is not None and self.caller.sees(owner)

    def batch(self, batch_id: str) -> BatchRecord:
        """The record of a batch of the caller's. Raises InputError (not found, 404)."""
        owner = self.batches.owner(batch_id)
        record = self.batches.read(batch_id) if owner and self.caller.sees(owner) else None
        if record is None:
            raise no_such_batch()
        return record

    def job(self, job_id: str) -> Job:
        """The job as it stands. One that Redis has lost is read from its folder.

        Raises InputError (not found, 404).
        """
        folder = self.folder(job_id)
        job = self.records.get(job_id)
        if job is None:
            try:
                self.records.restore(folder.request(), folder.outcome())
            except JobGone as error:
                raise no_such_job() from error
            job = self.records.get(job_id)
        if job is None:
            raise no_such_job()
        return self.line.placed([job])[0]


def no_such_job() -> InputError:
    """The answer to an id that names no job, malformed ones included."""
    return InputError(
        ProblemType.NOT_FOUND,
        "there is no such job: it never was, or it was erased. Remedy: take the id from the answer "
        "to your submission, or list your jobs at /v1/jobs.",
        status=404,
    )


def no_such_batch() -> InputError:
    """The answer to an id that names no batch of the caller's."""
    return InputError(
        ProblemType.NOT_FOUND,
        "there is no such batch: it never was, or it was erased. Remedy: take the id from the "
        "answer to your submission, or list your batches at /v1/batches.",
        status=404,
    )


async def access_of(request: Request) -> JobAccess:
    """The process's jobs, as the caller of this request sees them.

    It waits for nothing, and is a coroutine all the same, as its kin are: FastAPI hands each plain
    function to a thread, which costs more than what these do.
    """
    access: JobAccess = request.app.state.access
    return replace(access, caller=getattr(request.state, "caller", NOBODY))


async def owner_of(access: "Access") -> str:
    """Whose a job becomes that is submitted now."""
    return access.caller.owner


Access = Annotated[JobAccess, Depends(access_of)]
Owner = Annotated[str, Depends(owner_of)]
