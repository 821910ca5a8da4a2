"""`neuralmri audit`: what the audit log of a service says about a job."""

from pathlib import Path
from typing import Annotated

import typer

from cli.console import notice_console, say, say_json
from cli.input_arguments import JsonFlag
from cli.keys import DataDir
from schemas.audit import AuditEntry


def audit(
    job: Annotated[str, typer.Option(metavar="ID", help="The job, erased or not.")],
    data_dir: DataDir = Path("data"),
    as_json: JsonFlag = False,
) -> None:
    """Show who did what to a job and when: the proof of an erasure too. No service need run."""
    from jobs.store import is_job_id
    from schemas.problem import InputError, ProblemType
    from service.audit_search import entries_about

    if not is_job_id(job):
        raise InputError(
            ProblemType.INVALID_REQUEST, "a job's id is 32 hexadecimal digits; give it whole"
        )
    found = entries_about(data_dir / "audit", job)
    if as_json:
        entries = [entry.model_dump(mode="json", exclude_none=True) for entry in found]
        say_json({"entries": entries})
        return
    for entry in found:
        say(_line(entry))
    if not found:
        notice_console.print("The audit log says nothing of this job.")


def _line(entry: AuditEntry) -> str:
    line = f"{entry.at.isoformat(timespec='seconds')}  {entry.action:<8}  {entry.outcome:<7}"
    line += f"  by {entry.actor}"
    if entry.owner is not None:
        line += f" of {entry.owner}"
    if entry.expires_at is not None:
        line += f", had expired at {entry.expires_at.isoformat(timespec='seconds')}"
    return line
