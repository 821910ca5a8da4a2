"""Whether the service is alive, and whether it can take and finish work."""

from fastapi import APIRouter
from redis.exceptions import RedisError

from schemas.base import WireModel
from schemas.problem import InternalError, ProblemPart, ProblemType
from service.access import Access, JobAccess
from service.documented import problems

router = APIRouter(tags=["operation"])


class Alive(WireModel):
    """The process answers."""

    status: str = "alive"


class Ready(WireModel):
    """Redis and store answer, and these workers take jobs."""

    status: str = "ready"
    workers: list[str]


@router.get("/healthz", responses=problems())
def healthz() -> Alive:
    """Whether this process answers at all. It says nothing about Redis or workers."""
    return Alive()


@router.get("/readyz", responses=problems(503))
def readyz(access: Access) -> Ready:
    """Whether a job sent now would be taken and done; if not, the problem lists what is missing.

    A worker has to show it: by a heartbeat that it took from the queue and finished within the last
    minute, store included, or by a job that it holds.
    """
    missing: list[ProblemPart] = []
    workers: list[str] = []
    try:
        workers = access.live_workers()
        if not workers:
            missing.append(ProblemPart(pointer="workers", detail=_no_worker(access)))
        elif not access.is_work_done():
            missing.append(ProblemPart(pointer="workers", detail=_no_heartbeat(access)))
    except RedisError as error:
        detail = f"Redis does not answer ({type(error).__name__})"
        missing.append(ProblemPart(pointer="redis", detail=detail))
    trouble = access.store.trouble()
    if trouble is not None:
        missing.append(ProblemPart(pointer="store", detail=trouble))
    if missing:
        raise InternalError(
            ProblemType.UNAVAILABLE,
            "; ".join(part.detail for part in missing),
            status=503,
            errors=missing,
        )
    return Ready(workers=workers)


def _no_worker(access: JobAccess) -> str:
    return f"no worker said in {access.settings.worker_alive_s:g} s that it is alive"


def _no_heartbeat(access: JobAccess) -> str:
    return (
        f"workers say that they are alive, and none finished a heartbeat in "
        f"{access.settings.heartbeat_within_s:g} s; see their log"
    )
