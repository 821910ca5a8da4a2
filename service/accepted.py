"""The 202 answer to a submission."""

from typing import Any

from fastapi import Response

from schemas.job import Job
from service.held_answer import PREFERENCE_APPLIED
from service.settings import ServiceSettings

ACCEPTED: dict[int | str, dict[str, Any]] = {
    202: {
        "description": "Accepted: the job is stored and will be done, whatever happens to us.",
        "headers": {
            "Location": {"description": "The job.", "schema": {"type": "string"}},
            "Retry-After": {
                "description": "Seconds to wait before the first poll.",
                "schema": {"type": "integer", "minimum": 1},
            },
            **PREFERENCE_APPLIED,
        },
    }
}


def announce(job: Job, response: Response, settings: ServiceSettings) -> None:
    """Say where an accepted job is, and when to look."""
    response.headers["Location"] = job.links.self
    response.headers["Retry-After"] = str(settings.poll_after_s)
