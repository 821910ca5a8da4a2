"""`neuralmri demo`: a heart of known truth through the whole service, and back."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import notice_console, result_console, say
from schemas.labels import LabelRequest, LabelScheme
from schemas.messages import ContourRequest
from schemas.options import Options, Preset
from schemas.vocabulary import Axes, MeshFormat

if TYPE_CHECKING:
    from cli.client import Client
    from cli.inputs import ContourInput, LabelInput
    from cli.truth import Truth


def demo(
    out: Annotated[Path, typer.Option(help="Folder for what comes back.", file_okay=False)] = Path(
        "demo"
    ),
    data_dir: Annotated[
        Path | None,
        typer.Option(help="Where the server keeps its jobs.  [default: a temporary folder]"),
    ] = None,
    preset: Annotated[Preset, typer.Option(help="Of the reconstruction.")] = Preset.STANDARD,
    threads: Annotated[int, typer.Option(min=1, help="Threads of one job.")] = 1,
) -> None:
    """Start a server, send it a phantom heart as contours and as label maps, judge the results."""
    # The phantom draws on the science, which takes seconds to load.
    from cli.client import Client
    from cli.inputs import ContourInput, LabelInput
    from cli.ports import free_port
    from cli.server import ServerPlan, running
    from cli.truth import phantom_truth, write_phantom_maps
    from worker.phantom.standard_study import ONE_BEAT, standard_study

    options = Options.model_validate({"preset": preset, "formats": [MeshFormat.STL]})
    with _folder(data_dir) as data, tempfile.TemporaryDirectory() as maps:
        notice_console.print("Making a phantom heart ...")
        study = standard_study(ONE_BEAT)
        contours = ContourInput(ContourRequest(study=study, options=options), "/study")
        labels = LabelInput(
            LabelRequest(
                subject_id="phantom-maps",
                label_scheme=LabelScheme.ACDC,
                frame_labels=["ED"],
                options=options,
            ),
            write_phantom_maps(Path(maps), LabelScheme.ACDC),
        )
        plan = ServerPlan("127.0.0.1", free_port(), data, workers=2, threads=threads)
        notice_console.print("Starting Redis, worker and API ...")
        with running(plan), Client(plan.url) as client:
            notice_console.print(f"The server is ready at {plan.url}")
            jobs = {name: client.submit(given).id for name, given in _named(contours, labels)}
            for name, job_id in jobs.items():
                _follow(client, name, job_id, out / name)
    _judge("contours", out / "contours", phantom_truth(ONE_BEAT, Axes.LPS))
    _judge("label maps", out / "labels", phantom_truth({"ED": 0.0}, Axes.RAS))
    say(f"Meshes and reports are in {out}; open {out / 'contours' / 'report.html'}")


def _named(
    contours: "ContourInput", labels: "LabelInput"
) -> tuple[tuple[str, "ContourInput"], tuple[str, "LabelInput"]]:
    return ("contours", contours), ("labels", labels)


@contextmanager
def _folder(given: Path | None) -> Iterator[Path]:
    if given is not None:
        yield given
        return
    with tempfile.TemporaryDirectory(prefix="neuralmri-demo-") as folder:
        yield Path(folder)


def _follow(client: "Client", name: str, job_id: str, out: Path) -> None:
    """Wait for a job, fetch its files. Raises where it did not succeed."""
    from cli.following import wait_for
    from cli.progress import progress_bar
    from cli.server_errors import ended_badly

    with progress_bar(name, quiet=False) as bar:
        job = wait_for(client, job_id, bar.advanced)
    failure = ended_badly(job)
    if failure is not None:
        raise failure
    client.download(job_id, out)


def _judge(what: str, folder: Path, truth: "Truth") -> None:
    """What was found beside what is true."""
    from rich.table import Table

    from worker.evaluation.distance import surface_to_surface
    from worker.evaluation.size import volume_ml
    from worker.mesh_file import read_surface

    table = Table(title=f"Phantom from {what}, against its truth", title_justify="left")
    table.add_column("surface")
    for heading in ("true, mL", "found, mL", "mean distance, mm", "Hausdorff 95 %, mm"):
        table.add_column(heading, justify="right")
    for name, reference in truth.items():
        found = read_surface(folder / f"{name}.stl")
        distance = surface_to_surface(found, reference)
        table.add_row(
            name,
            f"{volume_ml(reference):.1f}",
            f"{volume_ml(found):.1f}",
            f"{distance.mean_mm:.2f}",
            f"{distance.hausdorff95_mm:.2f}",
        )
    result_console.print(table)
