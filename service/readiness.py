"""What is missing for a job sent now to be taken and done."""

from redis.exceptions import RedisError, ResponseError

from schemas.problem import ProblemPart
from service.access import JobAccess
from service.tokens.keys_at_hand import KeysAtHand


def missing(access: JobAccess, issuer_keys: KeysAtHand) -> list[ProblemPart]:
    """Each part that is not ready, by its pointer: `workers`, `redis`, `store`, `issuer`."""
    found: list[ProblemPart] = []
    try:
        access.workers.check_heard()
        if not access.live_workers():
            found.append(ProblemPart(pointer="workers", detail=_no_worker(access)))
        elif not access.is_work_done():
            found.append(ProblemPart(pointer="workers", detail=_no_heartbeat(access)))
    except ResponseError as error:
        detail = f"Redis takes no writes ({type(error).__name__})"
        found.append(ProblemPart(pointer="redis", detail=detail))
    except RedisError as error:
        detail = f"Redis does not answer ({type(error).__name__})"
        found.append(ProblemPart(pointer="redis", detail=detail))
    trouble = access.store.trouble()
    if trouble is not None:
        found.append(ProblemPart(pointer="store", detail=trouble))
    if (why := issuer_keys.missing()) is not None:
        found.append(ProblemPart(pointer="issuer", detail=why))
    return found


def _no_worker(access: JobAccess) -> str:
    return f"no worker said in {access.settings.worker_alive_s:g} s that it is alive"


def _no_heartbeat(access: JobAccess) -> str:
    return (
        f"workers say that they are alive, and none finished a heartbeat in "
        f"{access.settings.heartbeat_within_s:g} s; see their log"
    )
