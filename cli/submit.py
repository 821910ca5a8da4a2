"""`neuralmri submit`: the same inputs as `reconstruct`, done by a server."""

from pathlib import Path
from typing import Annotated

import typer

from cli.console import notice_console, say, say_json
from cli.effort import tell_effort
from cli.input_arguments import (
    FormatSettings,
    InputArgument,
    JsonFlag,
    OptionsFile,
    References,
)
from cli.inputs import ContourInput, read_input
from cli.label_arguments import LabelArguments, takes_label_maps
from cli.server_arguments import (
    DEFAULT_RETRY_WITHIN_S,
    LOCAL_SERVER,
    ApiKeyText,
    RetryWithin,
    ServerUrl,
    connected,
)
from schemas.job import Priority
from schemas.problem import InputError, ProblemType


@takes_label_maps()
def submit(
    study: InputArgument = None,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    wait: Annotated[bool, typer.Option("--wait", help="Follow the job to its end.")] = False,
    out: Annotated[
        Path | None, typer.Option(help="With --wait: folder for the artifacts.", file_okay=False)
    ] = None,
    priority: Annotated[
        Priority | None, typer.Option(help="Which jobs go first; interactive, if not given.")
    ] = None,
    reuse: Annotated[
        bool, typer.Option("--reuse", help="Have an earlier job of the same content and code.")
    ] = False,
    retain: Annotated[
        int | None,
        typer.Option("--retain", min=60, help="Seconds after its end that the job is kept."),
    ] = None,
    options: OptionsFile = None,
    *,
    maps: LabelArguments,
    reference: References = None,
    format_settings: FormatSettings = None,
    as_json: JsonFlag = False,
) -> None:
    """Send one subject to a server; with --wait follow it and fetch the results."""
    from cli.following import wait_for
    from cli.progress import progress_bar
    from cli.server_errors import ended_badly
    from cli.summary import print_summary

    if out is not None and not wait:
        raise InputError(ProblemType.INVALID_REQUEST, "--out needs --wait: add it")
    given = read_input(study, maps, options, reference or (), format_settings)
    with connected(server, api_key, retry_within) as client:
        if not as_json and isinstance(given, ContourInput):
            tell_effort(given.request.study, given.request.options)
        terms = {"priority": priority, "reuse": "true" if reuse else None, "retain_s": retain}
        job = client.submit(given, {k: str(v) for k, v in terms.items() if v is not None})
        if not as_json:
            notice_console.print(
                f"job {job.id} at {client.server}{job.links.self}", markup=False, soft_wrap=True
            )
        if wait:
            with progress_bar(given.subject_id, quiet=as_json) as bar:
                job = wait_for(client, job.id, bar.advanced)
            failure = ended_badly(job)
            if failure is not None:
                raise failure
            if out is not None:
                client.download(job.id, out)
        if as_json:
            say_json(job.model_dump(mode="json", exclude_none=True))
        elif wait:
            print_summary(client.report(job.id))
        else:
            say(job.id)
