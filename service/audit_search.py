"""What the audit log says about one job."""

from collections.abc import Iterator
from pathlib import Path

from schemas.audit import AuditEntry


def entries_about(folder: Path, job_id: str) -> list[AuditEntry]:
    """Lines about a job, oldest first, of all files of a log. Raises OSError."""
    found = [
        AuditEntry.model_validate_json(line)
        for path in sorted(folder.glob("*.jsonl"))
        for line in _lines_with(path, f'"{job_id}"')
    ]
    return sorted(found, key=lambda entry: entry.at)


def _lines_with(path: Path, text: str) -> Iterator[str]:
    with path.open(encoding="utf-8") as file:
        yield from (line for line in file if text in line)
