"""`neuralmri reconstruct`: the whole pipeline in this process, no server."""

import shutil
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from cli.console import say, say_json
from cli.effort import tell_effort
from cli.input_arguments import (
    FormatSettings,
    InputArgument,
    JsonFlag,
    OptionsFile,
    References,
)
from cli.inputs import read_input
from cli.label_arguments import LabelArguments, takes_label_maps
from cli.progress import progress_bar
from cli.summary import print_summary
from worker.cores import usable_cores
from worker.threads import bind_libraries

_MOST_BY_DEFAULT = 4
"""Processes: each takes memory of its own, and fits use two."""


@takes_label_maps()
def reconstruct(
    out: Annotated[Path, typer.Option(help="Folder for the artifacts.", file_okay=False)],
    study: InputArgument = None,
    options: OptionsFile = None,
    *,
    maps: LabelArguments,
    threads: Annotated[
        int, typer.Option(min=1, envvar="NEURALMRI_THREADS", help="Threads of the arithmetic.")
    ] = 1,
    processes: Annotated[
        int | None,
        typer.Option(
            min=1,
            envvar="NEURALMRI_PROCESSES",
            help="Frames worked on at a time.  [default: one per core, 4 at most]",
        ),
    ] = None,
    reference: References = None,
    format_settings: FormatSettings = None,
    as_json: JsonFlag = False,
) -> None:
    """Reconstruct one subject here and now, and write the same artifacts as a job."""
    bind_libraries(threads)
    given = read_input(study, maps, options, reference or (), format_settings)

    # The science, and only now: it takes seconds to load.
    from cli.reading import reading_of
    from intake.settings import LimitSettings
    from worker.artifacts.manifest import write_manifest
    from worker.subject import run

    limits = LimitSettings().limits()
    reading, pointer = reading_of(given, limits)
    out.mkdir(parents=True, exist_ok=True)
    # Beside its destination, so that what is there stays whole until the new is complete.
    with tempfile.TemporaryDirectory(prefix=".neuralmri-", dir=out) as folder:
        staging = Path(folder)
        if not as_json:
            tell_effort(reading.study, reading.options)
        with progress_bar(reading.study.subject_id, quiet=as_json) as bar:
            finished = run(
                reading.study,
                reading.options,
                staging,
                threads=threads,
                processes=processes or max(1, min(_MOST_BY_DEFAULT, usable_cores() // threads)),
                input_sha256=reading.input_sha256,
                warnings=reading.warnings,
                references=reading.references,
                observer=bar,
                pointer=pointer,
                limits=limits,
            )
        write_manifest(staging, finished.manifest)
        for path in staging.iterdir():
            shutil.move(path, out / path.name)
    if as_json:
        say_json(
            {
                "out": str(out),
                "manifest": finished.manifest.model_dump(mode="json"),
                "report": finished.report.model_dump(mode="json"),
            }
        )
        return
    print_summary(finished.report)
    say(f"{len(finished.manifest.artifacts) + 1} files in {out}")
