"""`neuralmri phantom`: a heart of known truth, its surfaces and its contour study."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

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
from schemas.messages import ContourRequest
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Axes, MeshFormat, Structure

if TYPE_CHECKING:
    from worker.phantom import Heart, HeartShape
    from worker.surface_mesh import SurfaceMesh


def phantom(
    out: Annotated[Path, typer.Option(help="Folder to write into.")],
    edge: Annotated[float, typer.Option(help="Triangle edge of the true surfaces, mm.")] = 1.0,
    mesh_format: Annotated[
        MeshFormat, typer.Option("--format", help="Of the true surfaces.")
    ] = MeshFormat.STL,
    spacing: SliceSpacing = 8.0,
    margin: Margin = 0.0,
    lax: LongAxisSlices = 3,
    point_spacing: PointSpacing = 1.0,
    shift_sd: ShiftDeviation = 0.0,
    noise_sd: NoiseDeviation = 0.0,
    shape: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="A number of the heart's shape, repeatable."),
    ] = None,
    subject_id: SubjectId = "phantom",
    seed: Seed = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print truth.json.")] = False,
) -> None:
    """Write a heart of known truth at end-diastole (ED) and end-systole (ES), LPS, mm.

    Into the folder go the true surfaces (ED_lv_endo.stl, ...), study.json (the contour study cut
    from them), request.json (the same as a request body, to POST) and truth.json (volumes,
    displacements, shape).
    """
    from worker.artifacts.meshes import write_mesh
    from worker.phantom import SlicingPlan, heart, slice_frames
    from worker.phantom.standard_study import ONE_BEAT

    plan = SlicingPlan(
        spacing_mm=spacing,
        margin_mm=margin,
        long_axis_planes=lax,
        point_spacing_mm=point_spacing,
        shift_sd_mm=shift_sd,
        noise_sd_mm=noise_sd,
        seed=seed,
    )
    form = _heart_shape(shape or ())
    hearts = {label: heart(phase, form) for label, phase in ONE_BEAT.items()}
    frames = {label: instant.meshes(edge) for label, instant in hearts.items()}
    sliced = slice_frames(frames, plan, subject_id=subject_id, axes=Axes.LPS)

    out.mkdir(parents=True, exist_ok=True)
    for label, meshes in frames.items():
        for structure, mesh in meshes.items():
            name = f"{label}_{structure.value}"
            write_mesh(out / f"{name}.{mesh_format.value}", mesh, name, Axes.LPS)
    write_study(out / "study.json", sliced.study)
    request = ContourRequest(study=sliced.study).model_dump_json(exclude_unset=True)
    (out / "request.json").write_text(request + "\n", encoding="utf-8")
    truth = {
        "subject_id": subject_id,
        "units": "mm",
        "axes": Axes.LPS.value,
        "shape": asdict(form),
        "slicing": asdict(plan),
        "edge_mm": edge,
        "frames": {
            label: _frame_truth(label, instant, frames[label], mesh_format)
            for label, instant in hearts.items()
        },
        "function": _function(hearts),
        "true_shifts_mm": {
            name: shift.round(6).tolist() for name, shift in sliced.true_shifts_mm.items()
        },
    }
    (out / "truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    if as_json:
        say_json(truth)
    else:
        say(_sentence(out, truth))


def _heart_shape(given: Iterable[str]) -> "HeartShape":
    from worker.phantom import HeartShape

    known = [field.name for field in fields(HeartShape)]
    numbers: dict[str, float] = {}
    for item in given:
        name, _, value = item.partition("=")
        try:
            numbers[name] = float(value)
        except ValueError as error:
            raise _refused(
                f"{item} is no NAME=VALUE with a number; write e.g. wall_mm=10"
            ) from error
        if name not in known:
            raise _refused(f"{name} is no number of a heart's shape; choose of {', '.join(known)}")
    return HeartShape(**numbers)


def _frame_truth(
    label: str,
    instant: "Heart",
    meshes: Mapping[Structure, "SurfaceMesh"],
    mesh_format: MeshFormat,
) -> dict[str, Any]:
    from worker.evaluation.size import area_cm2, volume_ml

    surfaces = {
        structure.value: {
            "file": f"{label}_{structure.value}.{mesh_format.value}",
            "volume_ml": volume_ml(mesh),
            "closed_form_volume_ml": instant.closed_form_volume_ml(structure),
            "area_cm2": area_cm2(mesh),
        }
        for structure, mesh in meshes.items()
    }
    return {"phase": instant.phase, "surfaces": surfaces}


def _function(hearts: Mapping[str, "Heart"]) -> dict[str, float]:
    from worker.evaluation.function import lv_function

    edv, esv = (
        hearts[label].layout.lv_inner.volume_below_ml(hearts[label].layout.base_mm)
        for label in ("ED", "ES")
    )
    return lv_function(edv, esv).model_dump(exclude_none=True)


def _sentence(out: Path, truth: Mapping[str, Any]) -> str:
    function = truth["function"]
    return (
        f"{out}  LV {function['lv_edv_ml']:.1f} mL at ED, {function['lv_esv_ml']:.1f} mL at ES, "
        f"ejection fraction {function['lv_ejection_fraction_percent']:.1f} %"
    )


def _refused(detail: str) -> InputError:
    return InputError(ProblemType.INVALID_REQUEST, detail + ".")
