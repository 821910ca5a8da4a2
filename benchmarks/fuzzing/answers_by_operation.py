"""How often each operation answered what, as the service itself counts it."""

from collections import Counter
from collections.abc import Mapping

import httpx
from prometheus_client.parser import text_string_to_metric_families

from benchmarks.fuzzing.running_service import RunningService

Counts = Counter[tuple[str, str]]
"""Answers by operation (`GET /v1/jobs`) and status."""

_OTHERS = "other methods"
_CLASSES = ("2xx", "3xx", "4xx", "5xx")


def answers_by_operation(service: RunningService) -> Counts:
    """Since the service began."""
    text = httpx.get(f"{service.url}/metrics", headers=service.headers).raise_for_status().text
    return Counter(
        {
            (f"{s.labels['method']} {s.labels['route']}", s.labels["status"]): int(s.value)
            for family in text_string_to_metric_families(text)
            for s in family.samples
            if s.name == "neuralmri_http_requests_total"
        }
    )


def table(counts: Mapping[tuple[str, str], int]) -> str:
    """Markdown: a line an operation, a column a class of statuses.

    Methods that an address does not take, all answered 405, share the last line.
    """
    folded: Counts = Counter()
    for (operation, status), number in counts.items():
        folded[_OTHERS if status == "405" else operation, status] += number
    counts = folded
    lines = [
        "| operation | requests | " + " | ".join(_CLASSES) + " |",
        "|---|" + "---|" * (1 + len(_CLASSES)),
    ]
    for operation in sorted({operation for operation, _ in counts}, key=lambda o: o.split()[::-1]):
        found = [
            sum(n for (o, status), n in counts.items() if o == operation and status[0] == cls[0])
            for cls in _CLASSES
        ]
        lines.append(f"| `{operation}` | " + " | ".join(map(str, [sum(found), *found])) + " |")
    return "\n".join(lines)
