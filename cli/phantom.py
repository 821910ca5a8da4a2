"""`neuralmri phantom`: a heart of known truth, its surfaces and its contour study."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cli.beat_arguments import (
    Beats,
    Edv,
    EjectionFraction,
    Frames,
    HeartRate,
    RvEjectionFraction,
    Shortening,
    Twist,
    beat_case,
    refuse_without_frames,
)
from cli.console import say, say_json
from cli.phantom_files import write_phantom
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
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Axes, MeshFormat, Structure

if TYPE_CHECKING:
    from worker.phantom import Heart, SlicingPlan
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
    frames: Frames = None,
    beat: Beats = None,
    heart_rate: HeartRate = None,
    edv: Edv = None,
    ejection_fraction: EjectionFraction = None,
    rv_ejection_fraction: RvEjectionFraction = None,
    shortening: Shortening = None,
    twist: Twist = None,
    subject_id: SubjectId = "phantom",
    seed: Seed = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print truth.json.")] = False,
) -> None:
    """Write a heart of known truth at end-diastole (ED) and end-systole (ES), LPS, mm; or with
    --frames over a whole beat.

    Into the folder go the true surfaces (ED_lv_endo.stl, ...), study.json (the contour study cut
    from them), request.json (the same as a request body, to POST) and truth.json (volumes,
    displacements, shape). With --frames also trajectories.npz: the vertices of one mesh a surface
    in every frame (F00 to the last).
    """
    from worker.phantom import SlicingPlan

    plan = SlicingPlan(
        spacing_mm=spacing,
        margin_mm=margin,
        long_axis_planes=lax,
        point_spacing_mm=point_spacing,
        shift_sd_mm=shift_sd,
        noise_sd_mm=noise_sd,
        seed=seed,
    )
    numbers = {
        "heart_rate_bpm": heart_rate,
        "edv_ml": edv,
        "ejection_fraction_percent": ejection_fraction,
        "rv_ejection_fraction_percent": rv_ejection_fraction,
        "longitudinal_shortening_percent": shortening,
        "twist_deg": twist,
    }
    if frames is None:
        refuse_without_frames(beat, numbers)
        truth = _write_two_phases(out, shape or (), plan, edge, mesh_format, subject_id)
    else:
        from cli.beating_phantom import OF_TWO_PHASES, write_beat
        from worker.phantom.beating import BeatingHeart

        case = beat_case(beat, numbers)
        form = _numbers_of_shape(shape or ())
        if idle := sorted(set(form) & set(OF_TWO_PHASES)):
            raise _refused(
                f"{', '.join(idle)} is of the heart without --frames; a beat has "
                "--ejection-fraction, --rv-ejection-fraction and --shortening"
            )
        heart = BeatingHeart(replace(case.shape, **form), case.beat)
        truth = write_beat(
            out,
            heart,
            frames,
            plan,
            edge_mm=edge,
            mesh_format=mesh_format,
            subject_id=subject_id,
        )
    if as_json:
        say_json(truth)
    else:
        say(_sentence(out, truth))


def _write_two_phases(
    out: Path,
    shape: Iterable[str],
    plan: "SlicingPlan",
    edge: float,
    mesh_format: MeshFormat,
    subject_id: str,
) -> dict[str, Any]:
    """End-diastole and end-systole, and what truth.json says of them."""
    from worker.phantom import HeartShape, heart, slice_frames
    from worker.phantom.standard_study import ONE_BEAT

    form = HeartShape(**_numbers_of_shape(shape))
    hearts = {label: heart(phase, form) for label, phase in ONE_BEAT.items()}
    frames = {label: instant.meshes(edge) for label, instant in hearts.items()}
    sliced = slice_frames(frames, plan, subject_id=subject_id, axes=Axes.LPS)
    write_phantom(out, frames, sliced.study, mesh_format)
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
    return truth


def _numbers_of_shape(given: Iterable[str]) -> dict[str, float]:
    """NAME=VALUE by name, each a field of `HeartShape`."""
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
    return numbers


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
