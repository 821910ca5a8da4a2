"""What the API description says about the answers that only a submission has."""

from typing import Any

from schemas.job import Job
from schemas.problem import InputError, ProblemType
from service.documented import described_problem
from service.held_answer import PREFERENCE_APPLIED
from service.refusals import key_pending

SUBMISSION: dict[int | str, dict[str, Any]] = {
    200: {
        "model": Job,
        "description": "With `reuse`: an earlier job of yours has these results.",
        "headers": {
            "Location": {"description": "The job.", "schema": {"type": "string"}},
            "Result-Reused": {
                "description": "Always there.",
                "schema": {"type": "string", "const": "true"},
            },
        },
    },
    202: {
        "description": "Accepted: the job is stored and will be done, whatever happens to us.",
        "headers": {
            "Location": {"description": "The job.", "schema": {"type": "string"}},
            "Retry-After": {
                "description": "Seconds to wait before the first poll: until the job is expected "
                "to start, at most an hour.",
                "schema": {"type": "integer", "minimum": 1, "maximum": 3600},
            },
            "Idempotency-Replayed": {
                "description": "`true` where the job was made by the same request before.",
                "schema": {"type": "string", "const": "true"},
            },
            **PREFERENCE_APPLIED,
        },
    },
    409: described_problem(
        "The same Idempotency-Key is being taken in by another request.", key_pending(), retry=True
    ),
    429: described_problem(
        "You have as many unfinished jobs as you may.",
        InputError(
            ProblemType.TOO_MANY_JOBS,
            "you have 20 unfinished jobs, as many as you may. Remedy: wait for one to end.",
            status=429,
        ),
        retry=True,
    ),
}
