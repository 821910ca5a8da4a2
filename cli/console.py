"""How commands speak: results on standard output, everything else on standard error."""

import json
import sys
from collections.abc import Mapping
from typing import Any

from rich.console import Console

from schemas.problem import ServiceError

result_console = Console(highlight=False)
"""For what was asked for."""

notice_console = Console(stderr=True, highlight=False)
"""For progress, hints and complaints."""


def say(sentence: str) -> None:
    """One plain line of result, at once, never wrapped or coloured."""
    print(sentence, flush=True)


def say_json(document: Mapping[str, Any]) -> None:
    """The result as one JSON document."""
    json.dump(document, sys.stdout, indent=1)
    sys.stdout.write("\n")


def complain(error: ServiceError, *, as_json: bool) -> None:
    """An error for a person, or as the problem document that the service would answer."""
    if as_json:
        say_json(error.problem().model_dump(mode="json", exclude_none=True))
        return
    notice_console.print("[bold red]Error:[/]", end=" ")
    notice_console.print(error.detail, markup=False, soft_wrap=True)
    others = [part for part in error.errors if part.pointer != error.pointer]
    if error.pointer is not None:
        notice_console.print(f"  at {error.pointer or 'the top level'}", markup=False)
    for part in others:
        notice_console.print(f"  at {part.pointer}: {part.detail}", markup=False, soft_wrap=True)
