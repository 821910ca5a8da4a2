"""The body of a batch of contour studies: one JSON document, or one study a line."""

import json
from dataclasses import dataclass
from typing import Any

from pydantic import Field

from intake.contour_request import read_contour_request
from intake.json_body import parse_json
from intake.limits import Limits
from schemas.base import FolderName, WireModel
from schemas.messages import ContourRequest
from schemas.options import under
from schemas.problem import InputError, ProblemType, ServiceError
from schemas.restart import RestartedOptions
from service.batches.joining import too_many

JSON = "application/json"
LINES = "application/x-ndjson"


class _Body(WireModel):
    """The whole, its studies yet unread."""

    studies: list[Any] = Field(min_length=1)
    options: dict[str, Any] = Field(default_factory=dict)


class _Study(WireModel):
    """One study, and what it says beside it, yet unread."""

    name: FolderName | None = None
    study: dict[str, Any]
    options: dict[str, Any] = Field(default_factory=dict)


@dataclass(frozen=True)
class ReadStudy:
    """One study of a batch: good, or refused. Pointers lead into the study's own entry."""

    name: str | None
    outcome: ContourRequest | ServiceError

    def good(self) -> ContourRequest:
        """The request. Raises the ServiceError with which the study is refused."""
        if isinstance(self.outcome, ServiceError):
            raise self.outcome
        return self.outcome


@dataclass(frozen=True)
class BatchBody:
    """A body that is a batch, its studies one by one, in order, and not yet judged."""

    entries: list[bytes]
    shared: dict[str, Any]

    def judged(self, limits: Limits) -> list[ReadStudy]:
        """Each study, judged as a submission of its own."""
        return [_read(entry, self.shared, limits) for entry in self.entries]


def read_batch(body: bytes, media_type: str, limits: Limits, most: int) -> BatchBody:
    """Take a batch apart. Raises InputError where the body as a whole is none, or holds more than
    `most` studies.
    """
    if media_type == LINES:
        lines = [line for line in body.split(b"\n") if line.strip()]
        if not lines:
            raise InputError(
                ProblemType.INVALID_REQUEST,
                "the body has no line. Remedy: send one study a line, as JSON.",
                pointer="/studies",
            )
        entries, shared = lines, {}
    else:
        whole = parse_json(body, _Body, limits)
        if whole.options:
            parse_json(json.dumps({"options": whole.options}).encode(), RestartedOptions, limits)
        entries = [json.dumps(entry).encode() for entry in whole.studies[: most + 1]]
        shared = whole.options
    if len(entries) > most:
        raise too_many(most, "/studies")
    return BatchBody(entries, shared)


def _read(entry: bytes, shared: dict[str, Any], limits: Limits) -> ReadStudy:
    name = None
    try:
        found = parse_json(entry, _Study, limits)
        name = found.name
        asked = {"study": found.study, "options": under(shared, found.options)}
        request, _ = read_contour_request(json.dumps(asked).encode(), limits)
    except ServiceError as error:
        return ReadStudy(name, error)
    return ReadStudy(name, request)
