"""A request's JSON: strict syntax, then the schema, every refusal with its place."""

from typing import Any, NoReturn, TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from intake.json_syntax import read_document, refuse_syntax, shown
from intake.limits import Limits
from schemas.base import WireModel
from schemas.problem import InputError, ProblemPart, ProblemType

M = TypeVar("M", bound=WireModel)

MAX_PARTS = 20
"""Faults listed in one answer."""


def parse_json(raw: bytes, model: type[M], limits: Limits) -> M:
    """`raw` as a `model`, with no conversion of types: "1" is not a number, NaN is not JSON.

    Raises:
        InputError: `MALFORMED_JSON` (400) with line and column; `TOO_LARGE` (413);
            `INVALID_REQUEST` (422) with one part for each fault, the first 20.
    """
    text, document = read_document(raw, limits)
    try:
        return model.model_validate_json(text, strict=True)
    except ValidationError as error:
        faults = error.errors(include_url=False, include_context=False, include_input=False)
        if faults[0]["type"] == "json_invalid":
            refuse_syntax(faults[0]["msg"].removeprefix("Invalid JSON: "), error)
        _refuse_content(faults, document, error)


def _refuse_content(faults: list[ErrorDetails], document: Any, cause: Exception) -> NoReturn:
    # A union reports every branch; the branch for text says nothing useful about an object.
    faults = sorted(faults, key=lambda f: f["type"] == "enum" and _is_object(document, f["loc"]))
    parts = [
        ProblemPart(pointer=_pointer(fault, document), detail=_sentence(fault))
        for fault in faults[:MAX_PARTS]
    ]
    more = f" (and {len(faults) - 1} more, see `errors`)" if len(faults) > 1 else ""
    raise InputError(
        ProblemType.INVALID_REQUEST,
        f"The request does not fit its schema at {parts[0].pointer or 'its top level'}: "
        f"{parts[0].detail}{more}. Remedy: correct what is listed; /openapi.json has the schema.",
        pointer=parts[0].pointer,
        errors=parts,
    ) from cause


def _sentence(fault: ErrorDetails) -> str:
    match fault["type"]:
        case "missing":
            return "required, and missing"
        case "extra_forbidden":
            return "unknown key; remove it or correct its spelling"
        case "string_pattern_mismatch":
            return (
                "a name has 1 to 64 letters, digits, dots, underscores or hyphens, and nothing else"
            )
        case _:
            message = fault["msg"].removeprefix("Value error, ").replace(" after validation", "")
            return message[:1].lower() + message[1:]


def _pointer(fault: ErrorDetails, document: Any) -> str:
    """JSON pointer of a fault: its location without the names that unions put in."""
    steps, value = [], document
    for step in fault["loc"]:
        if isinstance(value, dict) and step in value:
            value = value[str(step)]
        elif isinstance(value, list) and isinstance(step, int) and step < len(value):
            value = value[step]
        elif fault["type"] != "missing" or step != fault["loc"][-1]:
            continue
        steps.append(shown(str(step)).replace("~", "~0").replace("/", "~1"))
    return "".join(f"/{step}" for step in steps)


def _is_object(document: Any, loc: tuple[int | str, ...]) -> bool:
    value = document
    for step in loc:
        if not (isinstance(value, dict) and step in value):
            break
        value = value[str(step)]
    return isinstance(value, dict)
