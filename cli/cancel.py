"""`neuralmri cancel`: stop a job, keep it."""

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


def cancel(
    job_id: JobId,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: JsonFlag = False,
) -> None:
    """Ask a job to stop, and print its state. Doing it again, or too late, changes nothing."""
    with connected(server, api_key, retry_within) as client:
        job = client.cancel(job_id)
    if as_json:
        say_json(job.model_dump(mode="json", exclude_none=True))
    else:
        say(job.state)
