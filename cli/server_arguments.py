"""The arguments of commands that speak to a server, and the client that they make."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import notice_console
from schemas.problem import InputError, ProblemType

if TYPE_CHECKING:
    from cli.client import Client

LOCAL_SERVER = "http://127.0.0.1:8000"

ServerUrl = Annotated[
    str, typer.Option("--server", envvar="NEURALMRI_URL", help="Where the service is.")
]
RetryWithin = Annotated[
    float,
    typer.Option(
        "--retry-within",
        min=0.0,
        metavar="SECONDS",
        help="How long to go on asking a server that does not answer or is busy.",
    ),
]
DEFAULT_RETRY_WITHIN_S = 30.0

ApiKeyText = Annotated[
    str | None,
    typer.Option(
        "--api-key",
        envvar="NEURALMRI_API_KEY",
        show_envvar=True,
        metavar="KEY",
        help="The server's API key; better in the environment, which no list of processes shows.",
    ),
]


def _job_id(text: str) -> str:
    from jobs.store import is_job_id

    if not is_job_id(text):
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"{text!r} is no job id: 32 hexadecimal digits are; `neuralmri list` lists them",
        )
    return text


JobId = Annotated[
    str, typer.Argument(metavar="JOB", help="The job's id.", callback=_job_id, show_default=False)
]


def _job_or_batch_id(text: str) -> str:
    from jobs.batch_store import is_batch_id

    return text if is_batch_id(text) else _job_id(text)


JobOrBatchId = Annotated[
    str,
    typer.Argument(
        metavar="JOB",
        help="The job's id, or a batch's.",
        callback=_job_or_batch_id,
        show_default=False,
    ),
]


def is_batch(id_: str) -> bool:
    """Whether an id that the command line took is a batch's."""
    from jobs.batch_store import is_batch_id

    return is_batch_id(id_)


@contextmanager
def connected(server: str, api_key: str | None, retry_within_s: float) -> "Iterator[Client]":
    """A client that says on standard error when it has to ask again."""
    from cli.client import Client

    def tell(sentence: str) -> None:
        notice_console.print(sentence, markup=False, soft_wrap=True)

    with Client(server, api_key, retry_within_s=retry_within_s, tell=tell) as client:
        yield client
