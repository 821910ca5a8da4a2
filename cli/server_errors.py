"""What a server's refusals and a job's end mean here: the exceptions that the problems speak of."""

import json
from typing import Any

import httpx
from pydantic import ValidationError

from schemas.job import Job, JobState
from schemas.problem import Fault, InputError, InternalError, Problem, ProblemType, ServiceError


class ConnectionLostError(InternalError):
    """The server was not reached, or its answer broke off. This says nothing about a job.

    is_silence: the connection was there, and nothing came for too long.
    """

    def __init__(
        self, type_: ProblemType, detail: str, *, status: int, is_silence: bool = False
    ) -> None:
        super().__init__(type_, detail, status=status)
        self.is_silence = is_silence


def ended_badly(job: Job) -> ServiceError | None:
    """The error that a job's end means for who waited for it; None for success."""
    if job.state is JobState.SUCCEEDED:
        return None
    if job.error is not None:
        return error_of(job.error)
    return InputError(ProblemType.INVALID_REQUEST, f"job {job.id} was {job.state}; submit it again")


def error_of(problem: Problem) -> ServiceError:
    """The exception that a problem document speaks of."""
    kind = InputError if problem.fault is Fault.CALLER else InternalError
    name = problem.type.rpartition(":")[2]
    known = {type_.value: type_ for type_ in ProblemType}
    return kind(
        known.get(name, ProblemType.INTERNAL),
        problem.detail,
        pointer=problem.pointer,
        status=problem.status,
        errors=problem.errors,
    )


def document_of(response: httpx.Response) -> Any:
    """The JSON of an answer. Raises InternalError where it is none."""
    try:
        return response.json()
    except json.JSONDecodeError as error:
        raise InternalError(
            ProblemType.INTERNAL,
            f"{response.url} did not answer in JSON; is it a neuralmri server?",
        ) from error


def refusal_of(response: httpx.Response) -> ServiceError:
    """The exception for an answer that is no success."""
    try:
        problem = Problem.model_validate_json(response.content)
    except ValidationError:
        # Not our words: a proxy's, or another server's.
        return InternalError(
            ProblemType.INTERNAL,
            f"{response.url} answered {response.status_code} {response.reason_phrase}; "
            "is it a neuralmri server?",
        )
    return error_of(problem)
