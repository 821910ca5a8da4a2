"""`neuralmri download`: the files of a job that succeeded."""

from pathlib import Path
from typing import Annotated

import typer

from cli.console import say, say_json
from cli.input_arguments import JsonFlag
from cli.server_arguments import (
    DEFAULT_RETRY_WITHIN_S,
    LOCAL_SERVER,
    ApiKeyText,
    JobId,
    RetryWithin,
    ServerUrl,
    connected,
)


def download(
    job_id: JobId,
    out: Annotated[Path, typer.Option(help="Folder for the files.", file_okay=False)],
    name: Annotated[
        list[str] | None, typer.Option(help="Only this file. Give it once a file.")
    ] = None,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: JsonFlag = False,
) -> None:
    """Fetch a job's files and check their SHA-256. Run again, it goes on where it broke off."""
    with connected(server, api_key, retry_within) as client:
        manifest = client.download(job_id, out, name or ())
    if as_json:
        say_json(manifest.model_dump(mode="json", exclude_none=True))
        return
    for artifact in manifest.artifacts:
        if not name or artifact.name in name:
            say(str(out / artifact.name))
