"""What every answer to an upload has to be, however bad the upload was."""

import re
from functools import cache
from pathlib import Path

from benchmarks.fuzzing.upload import Answer
from schemas.problem import Problem
from service.security_headers import SECURITY_HEADERS

ROOT = Path(__file__).parents[2]

ANSWERED_WITHIN_S = 60.0
"""Against hangs; no judgement of speed."""

MEMORY_CAP_BYTES = 1 << 30
"""Of the service's process: half of what docker/compose.yaml gives its container."""

_URN = "urn:neuralmri:problem:"


def faults(answer: Answer) -> list[str]:
    """What is wrong with an answer; nothing where all is well.

    An answer is 202 or a problem document of a documented type that names a remedy. A request that
    is no HTTP is closed with a plain 400, or without a word.
    """
    if answer.status in (None, 202) or _is_no_http(answer):
        return []
    found = []
    if answer.status >= 500 and answer.status != 503:
        found.append(f"status {answer.status}")
    if answer.headers.get("content-type") != "application/problem+json":
        return [*found, f"media type {answer.headers.get('content-type')}"]
    problem = Problem.model_validate_json(answer.body)
    name = problem.type.removeprefix(_URN)
    if not remedies().get(name):
        found.append(f"type {problem.type} has no remedy in docs/problems.md")
    if "Remedy: " not in problem.detail:
        found.append(f"no remedy is named: {problem.detail}")
    if problem.status != answer.status:
        found.append(f"status {answer.status}, and {problem.status} in the document")
    if len(answer.body) > 100_000:
        found.append(f"a problem of {len(answer.body)} bytes")
    lacking = [name for name in SECURITY_HEADERS if name.lower() not in answer.headers]
    return [*found, *(f"header {name} is missing" for name in lacking)]


@cache
def remedies() -> dict[str, str]:
    """The remedy of every type in docs/problems.md."""
    text = (ROOT / "docs" / "problems.md").read_text(encoding="utf-8")
    sections = re.split(r"^### ", text, flags=re.MULTILINE)[1:]
    return {
        section.partition("\n")[0].strip(): " ".join(re.findall(r"\*\*Remedy\*\* ?(.+)", section))
        for section in sections
    }


def _is_no_http(answer: Answer) -> bool:
    return answer.status == 400 and answer.body == b"Invalid HTTP request received."
