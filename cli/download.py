"""`neuralmri download`: the files of a job that succeeded."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

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

if TYPE_CHECKING:
    from cli.client import Client


def download(
    job_id: JobOrBatchId,
    out: Annotated[Path, typer.Option(help="Folder for the files.", file_okay=False)],
    name: Annotated[
        list[str] | None, typer.Option(help="Only this file. Give it once a file.")
    ] = None,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: JsonFlag = False,
) -> None:
    """Fetch a job's files and check their SHA-256. Run again, it goes on where it broke off.

    Of a batch, those of every job that has succeeded, in a folder each.
    """
    with connected(server, api_key, retry_within) as client:
        if is_batch(job_id):
            _download_batch(client, job_id, out, name, as_json=as_json)
            return
        manifest = client.download(job_id, out, name or ())
    if as_json:
        say_json(manifest.model_dump(mode="json", exclude_none=True))
        return
    for artifact in manifest.artifacts:
        if not name or artifact.name in name:
            say(str(out / artifact.name))


def _download_batch(
    client: "Client", batch_id: str, out: Path, name: list[str] | None, *, as_json: bool
) -> None:
    from cli.batch_client import BatchClient

    if name:
        raise InputError(
            ProblemType.INVALID_REQUEST, "--name is of one job's files; leave it out for a batch"
        )
    batches = BatchClient(client)
    folders = batches.download(batches.batch(batch_id), out)
    if as_json:
        say_json({"folders": {job_id: str(folder) for job_id, folder in folders.items()}})
        return
    for folder in folders.values():
        say(str(folder))
