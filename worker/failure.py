"""How an attempt that went wrong is told to the caller: never a traceback, always what to do."""

import errno

from schemas.problem import InternalError, Problem, ProblemType, ServiceError


def problem_of(error: Exception, job_id: str) -> Problem:
    """The problem that a failed job carries. What is not a `ServiceError` is our surprise."""
    if isinstance(error, ServiceError):
        return error.problem(instance=_instance(job_id))
    if isinstance(error, MemoryError):
        return _ours(
            ProblemType.INTERNAL,
            f"Job {job_id} needed more memory than the worker has. Send fewer frames a job, or "
            "raise `mesh.grid_mm`.",
            job_id,
        )
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
        full = InternalError(
            ProblemType.STORAGE_FULL,
            f"Job {job_id} was computed, but the store is too full for its results. Erase jobs "
            "that are no longer needed, then send it again.",
            status=507,
        )
        return full.problem(instance=_instance(job_id))
    return _ours(
        ProblemType.INTERNAL,
        f"Job {job_id} failed for a reason that the service did not foresee; it is in the "
        "worker's log under this id. Sending the same again may help once; then tell the operator.",
        job_id,
    )


def timed_out(job_id: str, limit_s: int) -> Problem:
    """The job took longer than a job may."""
    return _ours(
        ProblemType.TIMED_OUT,
        f"Job {job_id} was stopped after {limit_s} s. Send fewer frames a job, choose the preset "
        "`fast`, or lower `levels` or `iterations_per_level`.",
        job_id,
    )


def worker_lost(job_id: str, attempts: int) -> Problem:
    """Every worker that took the job died of it."""
    return _ours(
        ProblemType.WORKER_LOST,
        f"Job {job_id} was given up: the worker was lost in each of {attempts} attempts, most "
        "likely for want of memory. Send fewer frames a job, or raise `mesh.grid_mm`.",
        job_id,
    )


def _ours(type_: ProblemType, detail: str, job_id: str) -> Problem:
    return InternalError(type_, detail).problem(instance=_instance(job_id))


def _instance(job_id: str) -> str:
    return f"/v1/jobs/{job_id}"
