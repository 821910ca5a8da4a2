"""`neuralmri cancel`: stop a job, keep it."""

from typing import Annotated

import typer

from cli.console import say, say_json
from cli.input_arguments import JsonFlag
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
from schemas.problem import InputError, ProblemType


def cancel(
    job_id: JobOrBatchId,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    keep_frames: Annotated[
        bool,
        typer.Option("--keep-frames", help="Have the frames that are finished as its results."),
    ] = False,
    as_json: JsonFlag = False,
) -> None:
    """Ask a job to stop, and print its state. Doing it again, or too late, changes nothing.

    Of a batch, every job of it.
    """
    if keep_frames and is_batch(job_id):
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "--keep-frames is for one job. Remedy: cancel the batch's jobs one by one.",
        )
    from cli.batch_client import BatchClient
    from cli.batch_summary import counts_line

    with connected(server, api_key, retry_within) as client:
        if is_batch(job_id):
            batch = BatchClient(client).cancel(job_id)
            document, state = batch.model_dump(mode="json", exclude_none=True), counts_line(batch)
        else:
            job = client.cancel(job_id, keeps_frames=keep_frames)
            document, state = job.model_dump(mode="json", exclude_none=True), job.state.value
    if as_json:
        say_json(document)
    else:
        say(state)
