"""`neuralmri serve`: the whole service on this machine."""

import time
from pathlib import Path
from typing import Annotated

import typer

from cli.console import say
from worker.cores import usable_cores

_LOOK_EVERY_S = 0.5


def serve(
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port to listen on.")] = 8000,
    data_dir: Annotated[
        Path, typer.Option(help="Where jobs, results and logs are kept.", file_okay=False)
    ] = Path("data"),
    workers: Annotated[
        int | None, typer.Option(min=1, help="Jobs at a time.  [default: one per core]")
    ] = None,
    threads: Annotated[
        int, typer.Option(min=1, envvar="NEURALMRI_THREADS", help="Threads of one job.")
    ] = 1,
    redis_url: Annotated[
        str | None, typer.Option(help="An outside Redis, instead of a private one.")
    ] = None,
    allow_remote: Annotated[
        bool,
        typer.Option(
            "--allow-remote",
            help="Let --host be one that other machines reach although there is no API key: all "
            "who reach it read and erase every job.",
        ),
    ] = False,
    ready_within: Annotated[
        float, typer.Option(min=1.0, help="Seconds that starting may take.")
    ] = 60.0,
) -> None:
    """Run API, workers and a private Redis together until stopped by Ctrl-C or SIGTERM."""
    from cli.server import ServerPlan, running

    plan = ServerPlan(
        host=host,
        port=port,
        data_dir=data_dir,
        workers=workers or max(1, usable_cores() // threads),
        threads=threads,
        redis_url=redis_url,
        ready_within_s=ready_within,
        allow_remote=allow_remote,
    )
    try:
        with running(plan) as server:
            say(f"neuralmri is ready at {plan.url} ({plan.workers} workers, data in {data_dir})")
            while True:
                server.check()
                time.sleep(_LOOK_EVERY_S)
    except KeyboardInterrupt:
        # The ordinary way to end a server.
        return
