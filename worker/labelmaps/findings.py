"""What a reader noticed and the report should say, gathered by kind over slices and frames."""

from collections.abc import Iterable
from dataclasses import dataclass

from schemas.vocabulary import View

_SHOWN = 4


@dataclass(frozen=True)
class Finding:
    """One thing noticed at one place (a slice of a frame)."""

    view: View
    what: str
    place: str


def as_warnings(findings: Iterable[Finding]) -> list[str]:
    """One sentence a kind and view, with the first few places."""
    places: dict[tuple[View, str], list[str]] = {}
    for finding in findings:
        places.setdefault((finding.view, finding.what), []).append(finding.place)
    return [f"{view}: {what} ({_some(where)})." for (view, what), where in places.items()]


def _some(places: list[str]) -> str:
    shown = ", ".join(places[:_SHOWN])
    return shown if len(places) <= _SHOWN else f"{shown} and {len(places) - _SHOWN} more"
