"""Strict JSON syntax, at a bounded cost."""

import json
import re
from collections import Counter
from typing import Any, NoReturn

import numpy as np

from intake.limits import Limits
from schemas.problem import InputError, ProblemType

MAX_KEYS = 1000
"""Keys of one object: each unknown one would cost a report of its own."""

_FEWER_POINTS = "resample the contours to 100 to 300 points each, or send fewer frames a job"

# Possessive: megabytes of backslashes cost a scan, and no memory of where to go back to.
_STRING = re.compile(rb'"(?:[^"\\]++|\\.)*+"?', re.DOTALL)
_CONSTANT = re.compile(r'"[^"\\]*(?:\\.[^"\\]*)*"?|(-?Infinity|NaN)', re.DOTALL)
_NOT_BRACKETS = bytes(set(range(256)) - set(b"[]{}"))


def read_document(raw: bytes, limits: Limits) -> tuple[str, Any]:
    """The text in `raw`, and the document it holds: UTF-8, finite numbers, no key twice.

    Raises:
        InputError: `MALFORMED_JSON` (400) with line and column; `TOO_LARGE` (413).
    """
    _check_extent(raw, limits)
    text = _decode(raw)
    return text, _parse(text)


def refuse_syntax(detail: str, cause: Exception | None = None) -> NoReturn:
    """Raise `MALFORMED_JSON` (400)."""
    raise InputError(
        ProblemType.MALFORMED_JSON,
        f"The body is not valid JSON: {detail}. Remedy: write it with a JSON library, in UTF-8.",
        status=400,
    ) from cause


def _check_extent(raw: bytes, limits: Limits) -> None:
    """Bounds what parsing can cost, from the brackets and commas outside strings."""
    if len(raw) > limits.max_request_bytes:
        _refuse_size("bytes", len(raw), limits.max_request_bytes, _FEWER_POINTS)
    bare = _STRING.sub(b"", raw)
    brackets = np.frombuffer(bare.translate(None, delete=_NOT_BRACKETS), dtype=np.uint8)
    opening = (brackets == ord("[")) | (brackets == ord("{"))
    values = bare.count(b",") + int(opening.sum()) + 1
    if values > limits.max_json_values:
        _refuse_size("JSON values", values, limits.max_json_values, _FEWER_POINTS)
    depth = int(np.cumsum(np.where(opening, 1, -1)).max(initial=0))
    if depth > limits.max_json_depth:
        remedy = "nest no deeper than the schema"
        _refuse_size("levels of nested JSON", depth, limits.max_json_depth, remedy)


def _decode(raw: bytes) -> str:
    if raw.startswith(b"\xef\xbb\xbf"):
        refuse_syntax("the body starts with a byte order mark; send UTF-8 without one")
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError as error:
        refuse_syntax(f"byte {error.start} is not UTF-8; encode the body as UTF-8", error)


def _parse(text: str) -> Any:
    def refuse_constant(name: str) -> NoReturn:
        at = next(m.start(1) for m in _CONSTANT.finditer(text) if m.group(1))
        refuse_syntax(
            f"{name} is not JSON at {_place(text, at)}; leave out what is not a finite number"
        )

    try:
        return json.loads(text, parse_constant=refuse_constant, object_pairs_hook=_unique)
    except json.JSONDecodeError as error:
        refuse_syntax(f"{error.msg} at line {error.lineno} column {error.colno}", error)
    except ValueError as error:  # an integer of more digits than Python converts
        refuse_syntax("an integer has thousands of digits; send finite numbers", error)


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len(pairs) > MAX_KEYS:
        _refuse_size("keys in one object", len(pairs), MAX_KEYS, "send the schema's keys alone")
    members = dict(pairs)
    if len(members) < len(pairs):
        key = next(k for k, n in Counter(k for k, _ in pairs).items() if n > 1)
        refuse_syntax(f"the key {shown(key)} stands twice in one object; keep one of them")
    return members


def _refuse_size(what: str, found: int, limit: int, remedy: str) -> NoReturn:
    raise InputError(
        ProblemType.TOO_LARGE,
        f"The body holds {found} {what}; at most {limit} are accepted. Remedy: {remedy}.",
        status=413,
    )


def _place(text: str, at: int) -> str:
    return f"line {text.count(chr(10), 0, at) + 1} column {at - text.rfind(chr(10), 0, at)}"


def shown(key: str) -> str:
    """A caller's key, fit to print: no lone surrogates, no endless names."""
    return key[:64].encode("utf-8", "backslashreplace").decode("utf-8")
