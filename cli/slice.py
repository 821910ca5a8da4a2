"""`neuralmri slice`: closed surfaces in, the contour study of a scanner out."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import say, say_json
from cli.slicing_arguments import (
    LongAxisSlices,
    Margin,
    NoiseDeviation,
    PointSpacing,
    Seed,
    ShiftDeviation,
    SliceSpacing,
    SubjectId,
)
from cli.study_file import write_study
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Axes, Structure

if TYPE_CHECKING:
    from worker.surface_mesh import SurfaceMesh


def slice_(
    meshes: Annotated[
        list[str],
        typer.Argument(
            metavar="MESH...",
            help="Closed surfaces (STL, OBJ, PLY; mm), named by frame and structure as in "
            "ED_lv_endo.stl or lv_endo.ply; any other file as ED_lv_endo=FILE.",
        ),
    ],
    out: Annotated[Path, typer.Option(help="Where to write the contour study (JSON).")],
    spacing: SliceSpacing = 8.0,
    margin: Margin = 0.0,
    lax: LongAxisSlices = 3,
    point_spacing: PointSpacing = 1.0,
    shift_sd: ShiftDeviation = 0.0,
    noise_sd: NoiseDeviation = 0.0,
    axis: Annotated[
        tuple[float, float, float] | None,
        typer.Option(metavar="X Y Z", help="From apex to base; left out, found from the LV."),
    ] = None,
    axes: Annotated[Axes, typer.Option(help="Patient axes that the meshes are in.")] = Axes.LPS,
    frame: Annotated[str, typer.Option(help="Frame of meshes whose name tells none.")] = "ED",
    subject_id: SubjectId = "sliced",
    seed: Seed = 0,
    shifts_out: Annotated[
        Path | None, typer.Option(help="Where to write the true displacements (JSON, mm).")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON for machines.")] = False,
) -> None:
    """Cut closed surfaces by short-axis and long-axis planes into a contour study."""
    from worker.phantom.slicing import slice_frames
    from worker.phantom.slicing_plan import SlicingPlan

    plan = SlicingPlan(
        spacing_mm=spacing,
        margin_mm=margin,
        long_axis_planes=lax,
        point_spacing_mm=point_spacing,
        shift_sd_mm=shift_sd,
        noise_sd_mm=noise_sd,
        axis=axis,
        seed=seed,
    )
    sliced = slice_frames(_frames(meshes, frame), plan, subject_id=subject_id, axes=axes)
    write_study(out, sliced.study)
    if shifts_out:
        shifts = {name: shift.round(6).tolist() for name, shift in sliced.true_shifts_mm.items()}
        shifts_out.parent.mkdir(parents=True, exist_ok=True)
        shifts_out.write_text(json.dumps(shifts, indent=1) + "\n", encoding="utf-8")
    counts = {f.label: len(f.slices) for f in sliced.study.frames}
    if as_json:
        say_json({"study": str(out), "slices": counts})
    else:
        found = ", ".join(f"{label}: {count} slices" for label, count in counts.items())
        say(f"{out}  {found}")


def _frames(named: Iterable[str], default_label: str) -> dict[str, dict[Structure, "SurfaceMesh"]]:
    """Surfaces by frame label and structure, in the order given."""
    from worker.mesh_file import read_surface

    frames: dict[str, dict[Structure, SurfaceMesh]] = {}
    for argument in named:
        name, given, file = argument.partition("=")
        path = Path(file if given else argument)
        label, structure = _frame_and_structure(name if given else path.stem, argument)
        surfaces = frames.setdefault(label or default_label, {})
        if structure in surfaces:
            raise InputError(
                ProblemType.INVALID_REQUEST,
                f"{argument} is a second {structure.value} of frame {label or default_label}; "
                "name its frame, as in ES_lv_endo=FILE.",
            )
        surfaces[structure] = read_surface(path)
    return frames


def _frame_and_structure(name: str, argument: str) -> tuple[str, Structure]:
    """("ED", lv_endo) of "ED_lv_endo", ("", lv_endo) of "lv_endo"."""
    # The longest first: lv_epi ends with epi.
    for structure in sorted(Structure, key=lambda s: -len(s.value)):
        label, found, rest = name.lower().rpartition(structure.value)
        if found and not rest and (not label or label[-1] in "_-."):
            return name[: len(label)].rstrip("_-."), structure
    raise InputError(
        ProblemType.INVALID_REQUEST,
        f"{argument} does not tell its structure; write e.g. lv_endo={argument.rpartition('=')[2]} "
        f"with one of {', '.join(s.value for s in Structure)}.",
    )
