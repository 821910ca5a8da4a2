"""`neuralmri list`: the caller's jobs on a server."""

from typing import Annotated

import typer

from cli.console import notice_console, say, say_json
from cli.input_arguments import JsonFlag
from cli.server_arguments import (
    DEFAULT_RETRY_WITHIN_S,
    LOCAL_SERVER,
    ApiKeyText,
    RetryWithin,
    ServerUrl,
    connected,
)
from schemas.job import Job, JobPage, JobState

_MOST_A_PAGE = 200


def list_jobs(
    state: Annotated[JobState | None, typer.Option(help="Only jobs in this state.")] = None,
    limit: Annotated[int, typer.Option(min=1, max=_MOST_A_PAGE, help="Jobs of one page.")] = 50,
    cursor: Annotated[
        str | None, typer.Option(help="Where a page before said that it goes on.")
    ] = None,
    all_pages: Annotated[bool, typer.Option("--all", help="All pages, one after another.")] = False,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: JsonFlag = False,
) -> None:
    """List jobs, newest first: id, kind, state, how far, when it was accepted."""
    with connected(server, api_key, retry_within) as client:
        page = client.jobs(state, limit, cursor)
        while all_pages and page.next_cursor is not None:
            more = client.jobs(state, limit, page.next_cursor)
            page = JobPage(jobs=[*page.jobs, *more.jobs], next_cursor=more.next_cursor)
    if as_json:
        say_json(page.model_dump(mode="json", exclude_none=True))
        return
    for job in page.jobs:
        say(_line(job))
    if page.next_cursor is not None:
        notice_console.print(f"more with --cursor {page.next_cursor}", soft_wrap=True)


def _line(job: Job) -> str:
    accepted = job.created_at.isoformat(timespec="seconds")
    done = f"{job.progress.fraction:.0%}"
    line = f"{job.id}  {job.kind:<8}  {job.state:<10}  {done:>4}  {accepted}"
    if job.expires_at is None:
        return line
    return f"{line}  expires {job.expires_at.isoformat(timespec='seconds')}"
