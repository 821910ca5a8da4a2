"""The arguments of every command that talks to a server."""

from typing import Annotated

import typer

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
