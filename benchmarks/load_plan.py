"""What load is sent, and what was measured of it: the words between two processes."""

import random
from collections.abc import Sequence
from enum import StrEnum

from schemas.base import WireModel


class Route(StrEnum):
    """What is asked, as the API spells it."""

    JOB = "GET /v1/jobs/{job_id}"
    LIST = "GET /v1/jobs"
    EVENTS = "GET /v1/jobs/{job_id}/events"
    SUBMIT = "POST /v1/jobs/contours"


SHARES = {Route.JOB: 0.74, Route.LIST: 0.1, Route.EVENTS: 0.1, Route.SUBMIT: 0.06}
"""At 50 requests a second, three submissions."""


class Due(WireModel):
    """One request and its instant, s from the start."""

    at_s: float
    route: Route
    path: str


class LoadPlan(WireModel):
    """Where to send what. body: of each submission."""

    url: str
    body: str
    due: list[Due]


class Sample(WireModel):
    """One answer. status: 0 where there was none.

    latency_s: from its instant on the schedule. late_s: how long after it the client sent it.
    served_s: from sending to the answer, as closed-loop tools have it.
    """

    route: Route
    latency_s: float
    late_s: float
    served_s: float
    status: int


class Samples(WireModel):
    """Of one run. dropped: not answered in the end."""

    done: list[Sample]
    dropped: int


def schedule(
    rate_hz: float, seconds: float, jobs: Sequence[str], ended: Sequence[str], seed: int
) -> list[Due]:
    """A request every 1 / rate_hz, its route drawn by share.

    jobs: ids that are polled. ended: ids whose events are read, to the end of the stream.
    """
    draw = random.Random(seed)
    routes = draw.choices(list(SHARES), weights=list(SHARES.values()), k=int(rate_hz * seconds))
    paths = {
        Route.JOB: [f"/v1/jobs/{job_id}" for job_id in jobs],
        Route.LIST: ["/v1/jobs"],
        Route.EVENTS: [f"/v1/jobs/{job_id}/events" for job_id in ended],
        Route.SUBMIT: ["/v1/jobs/contours"],
    }
    return [
        Due(at_s=place / rate_hz, route=route, path=draw.choice(paths[route]))
        for place, route in enumerate(routes)
    ]
