"""`neuralmri erase`: remove a job from a server for good."""

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
)


def erase(
    job_id: JobOrBatchId,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: JsonFlag = False,
) -> None:
    """Remove a job with its inputs and results; one that runs is stopped. There is no way back.

    Of a batch, every job of it.
    """
    with connected(server, api_key, retry_within) as client:
        client.erase(job_id)
    if as_json:
        say_json({"id": job_id, "erased": True})
    else:
        say("erased")
