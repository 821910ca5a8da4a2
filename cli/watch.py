"""`neuralmri watch`: follow a job that a server has."""

from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from cli.console import notice_console, say
from cli.exit_code import exit_code
from cli.server_arguments import (
    DEFAULT_RETRY_WITHIN_S,
    LOCAL_SERVER,
    ApiKeyText,
    JobOrBatchId,
    RetryWithin,
    ServerUrl,
    connected,
    is_batch,
)
from schemas.event import JobEvent
from schemas.problem import ServiceError

if TYPE_CHECKING:
    from cli.client import Client


def watch(
    job_id: JobOrBatchId,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one line of JSON for each event.")
    ] = False,
) -> None:
    """Follow a job to its end, and show how far it is.

    Lost connections are made anew. Exit code as of `submit --wait`. A batch is polled; `--json`
    prints it once it has ended.
    """
    from cli.following import follow, progress_of
    from cli.progress import progress_bar
    from cli.server_errors import ended_badly
    from cli.summary import print_summary

    with connected(server, api_key, retry_within) as client:
        if is_batch(job_id):
            _watch_batch(client, job_id, as_json=as_json)
        try:
            with progress_bar(job_id[:8], quiet=as_json) as bar:

                def tell(event: JobEvent) -> None:
                    if as_json:
                        say(event.model_dump_json())
                    else:
                        bar.advanced(progress_of(event))

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


def _watch_batch(client: "Client", batch_id: str, *, as_json: bool) -> NoReturn:
    from cli.batch_client import BatchClient
    from cli.batch_summary import batch_exit_code, say_batch
    from cli.batch_watch import watched

    batch = watched(BatchClient(client), batch_id, quiet=as_json)
    if as_json:
        say(batch.model_dump_json(exclude_none=True))
    else:
        say_batch(batch)
    raise typer.Exit(batch_exit_code(batch))
