"""Whether the service is alive, and whether it can take and finish work."""

from fastapi import APIRouter, Request

from schemas.base import WireModel
from schemas.problem import InternalError, ProblemType
from service.access import Access
from service.documented import problems
from service.readiness import missing

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
def readyz(access: Access, request: Request) -> Ready:
    """Whether a job sent now would be taken and done; if not, the problem lists what is missing.

    A worker has to show it: by a heartbeat that it took from the queue and finished within the last
    minute, store included, or by a job that it holds.
    """
    lacking = missing(access, request.app.state.issuer_keys)
    if lacking:
        raise InternalError(
            ProblemType.UNAVAILABLE,
            "; ".join(part.detail for part in lacking),
            status=503,
            errors=lacking,
        )
    return Ready(workers=access.live_workers())
