"""`neuralmri submit-batch`: many contour studies to a server, under one parent."""

from pathlib import Path
from typing import Annotated

import typer

from cli.batch_files import read_batch_files
from cli.console import notice_console, say, say_json
from cli.input_arguments import JsonFlag, OptionsFile
from cli.server_arguments import (
    DEFAULT_RETRY_WITHIN_S,
    LOCAL_SERVER,
    ApiKeyText,
    RetryWithin,
    ServerUrl,
    connected,
)
from schemas.problem import InputError, ProblemType


def submit_batch(
    paths: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE_OR_FOLDER...",
            help="Contour studies or requests as JSON; of a folder every *.json.",
            exists=True,
            show_default=False,
        ),
    ],
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    wait: Annotated[bool, typer.Option("--wait", help="Follow the batch to its end.")] = False,
    out: Annotated[
        Path | None,
        typer.Option(help="With --wait: folder for results, one in it a study.", file_okay=False),
    ] = None,
    options: OptionsFile = None,
    as_json: JsonFlag = False,
) -> None:
    """Send many studies at once; with --wait follow them and fetch the results.

    Each is accepted or refused by itself. Exit code 0 where nothing was refused or went wrong.
    """
    from cli.batch_client import BatchClient
    from cli.batch_summary import batch_exit_code, notice_refusals, say_batch
    from cli.batch_watch import watched

    if out is not None and not wait:
        raise InputError(ProblemType.INVALID_REQUEST, "--out needs --wait: add it")
    body = read_batch_files(paths, options)
    with connected(server, api_key, retry_within) as client:
        batches = BatchClient(client)
        batch = batches.submit(body)
        if not as_json:
            notice_console.print(f"batch {batch.id} at {client.server}{batch.links.self}")
            notice_refusals(batch)
        if wait:
            batch = watched(batches, batch.id, quiet=as_json)
            if out is not None:
                batches.download(batch, out)
    if as_json:
        say_json(batch.model_dump(mode="json", exclude_none=True))
    elif wait:
        say_batch(batch)
    else:
        say(batch.id)
    raise typer.Exit(batch_exit_code(batch))
