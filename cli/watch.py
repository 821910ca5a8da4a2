"""`neuralmri watch`: follow a job that a server has."""

from typing import Annotated

import typer

from cli.console import notice_console, say
from cli.exit_code import exit_code
from cli.server_arguments import (
    DEFAULT_RETRY_WITHIN_S,
    LOCAL_SERVER,
    ApiKeyText,
    JobId,
    RetryWithin,
    ServerUrl,
    connected,
)
from schemas.event import JobEvent
from schemas.job import Job
from schemas.problem import ServiceError


def watch(
    job_id: JobId,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one line of JSON for each event.")
    ] = False,
) -> None:
    """Follow a job to its end, and show how far it is.

    Lost connections are made anew. Exit code as of `submit --wait`.
    """
    from cli.following import follow
    from cli.progress import progress_bar
    from cli.server_errors import ended_badly
    from cli.summary import print_summary

    with connected(server, api_key, retry_within) as client:
        try:
            with progress_bar(job_id[:8], quiet=as_json) as bar:

                def tell(event: JobEvent) -> None:
                    if as_json:
                        say(event.model_dump_json())
                    else:
                        data = event.data
                        bar.advanced(data.progress if isinstance(data, Job) else data)

                job = follow(client, job_id, tell)
        except ServiceError as error:
            if not as_json:
                raise
            say(error.problem().model_dump_json(exclude_none=True))
            raise typer.Exit(exit_code(error)) from error
        if job.expires_at is not None and not as_json:
            until = job.expires_at.isoformat(timespec="minutes")
            notice_console.print(f"the job is kept until {until}", soft_wrap=True)
        failure = ended_badly(job)
        if failure is not None:
            if not as_json:
                raise failure
            raise typer.Exit(exit_code(failure))  # the last event holds the error
        if not as_json:
            print_summary(client.report(job.id))
