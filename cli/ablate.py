"""`neuralmri ablate`: how good surfaces are when refinement ends at level 0, 1, ..."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cli.ablation_table import print_ablation
from cli.console import notice_console, say, say_json
from cli.input_arguments import (
    InputArgument,
    JsonFlag,
    OptionsFile,
    References,
)
from cli.inputs import ContourInput, read_input
from cli.label_arguments import LabelArguments, takes_label_maps
from cli.progress import progress_bar
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Axes
from worker.threads import bind_libraries, use_threads

if TYPE_CHECKING:
    from worker.ablation_row import AblatedSurface
    from worker.reading import Reading


@takes_label_maps()
def ablate(
    out: Annotated[Path, typer.Option(help="Folder for the results.", file_okay=False)],
    study: InputArgument = None,
    levels: Annotated[
        str | None,
        typer.Option(
            metavar="FIRST..LAST",
            help="Levels at which refinement ends, or some of them as in 0,2,5. All if left out.",
        ),
    ] = None,
    options: OptionsFile = None,
    *,
    maps: LabelArguments,
    threads: Annotated[
        int, typer.Option(min=1, envvar="NEURALMRI_THREADS", help="Threads of the arithmetic.")
    ] = 1,
    reference: References = None,
    as_json: JsonFlag = False,
) -> None:
    """Reconstruct one subject again and again, refined up to one level more each time.

    Into the folder go ablation.json, a row a level and surface, and level-N/NAME.vtp, the surfaces,
    with the distance to the reference at every vertex.
    """
    bind_libraries(threads)
    given = read_input(study, maps, options, reference or ())
    ends = None if levels is None else parsed_levels(levels)

    from intake.settings import LimitSettings
    from intake.study import admit
    from worker.reading import read_contours, read_labels, with_references

    limits = LimitSettings().limits()
    if isinstance(given, ContourInput):
        reading, pointer = read_contours(given.request), given.pointer
    else:
        reading, pointer = read_labels(given.files, given.request, limits), "/study"
    reading = with_references(reading, given.references, limits, pointer=pointer)
    warnings = [
        *reading.warnings,
        *admit(reading.study, reading.options, limits, pointer=pointer),
    ]
    out.mkdir(parents=True, exist_ok=True)

    use_threads(threads)
    # After the threads are bound: loads torch.
    from worker.ablation import ablate as ablated

    with progress_bar(reading.study.subject_id, quiet=as_json) as bar:
        surfaces = ablated(
            reading.study,
            reading.options,
            range(reading.options.levels) if ends is None else ends,
            reading.references,
            bar,
        )
    document = _document(reading, surfaces, warnings, threads)
    _write(out, surfaces, document, reading.study.axes)
    if as_json:
        say_json({"out": str(out), **document})
        return
    print_ablation([one.row for one in surfaces])
    for warning in warnings:
        notice_console.print(f"Warning: {warning}", markup=False, soft_wrap=True)
    say(f"ablation.json and {len(surfaces)} surfaces in {out}")


def parsed_levels(text: str) -> list[int]:
    """[0, 1, 2] of "0..2", [0, 5] of "0,5", ascending. Raises InputError."""
    parts = [re.fullmatch(r"\s*(\d{1,2})(?:\.\.(\d{1,2}))?\s*", part) for part in text.split(",")]
    found = [range(int(p[1]), int(p[2] or p[1]) + 1) for p in parts if p]
    if len(found) < len(parts) or not all(found):
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"{text} names no levels; write FIRST..LAST as in 0..5, or some as in 0,2,5.",
        )
    return sorted({level for part in found for level in part})


def _document(
    reading: "Reading", surfaces: Sequence["AblatedSurface"], warnings: list[str], threads: int
) -> dict[str, Any]:
    from worker.provenance import provenance

    made = provenance(seed=reading.options.seed, threads=threads, input_sha256=reading.input_sha256)
    return {
        "subject_id": reading.study.subject_id,
        "axes": reading.study.axes.value,
        "rows": [asdict(one.row) for one in surfaces],
        "warnings": warnings,
        "options": reading.options.model_dump(mode="json"),
        "provenance": made.model_dump(mode="json"),
    }


def _write(
    out: Path, surfaces: Sequence["AblatedSurface"], document: Mapping[str, Any], axes: Axes
) -> None:
    from worker.artifacts.meshes import write_mesh

    for one in surfaces:
        name = f"{one.row.frame}_{one.row.surface}"
        folder = out / f"level-{one.row.level}"
        folder.mkdir(exist_ok=True)
        known = {} if one.distance_mm is None else {"distance_mm": one.distance_mm}
        write_mesh(folder / f"{name}.vtp", one.mesh, name, axes, known)
    text = json.dumps(document, indent=1, allow_nan=False) + "\n"
    (out / "ablation.json").write_text(text, encoding="utf-8")
