"""The arguments of `phantom` that say how a heart beats, and the beat that they make."""

from collections.abc import Mapping
from dataclasses import replace
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any

import typer

from schemas.problem import InputError, ProblemType

if TYPE_CHECKING:
    from worker.phantom.beating import Case


class BeatName(StrEnum):
    """Which heart beats; each other number that is given replaces the preset's."""

    HEALTHY = "healthy"
    DILATED = "dilated"
    INFARCT = "infarct"


Frames = Annotated[
    int | None,
    typer.Option(
        help="Frames evenly over one beat (F00 is end-diastole), with the path of every vertex; "
        "left out: ED and ES."
    ),
]
Beats = Annotated[
    BeatName | None, typer.Option("--beat", help="Whose beat, with --frames: healthy if left out.")
]
HeartRate = Annotated[float | None, typer.Option(help="Beats per minute, 40 to 150.")]
Edv = Annotated[
    float | None, typer.Option(help="LV volume at end-diastole, mL: scales the whole heart.")
]
EjectionFraction = Annotated[float | None, typer.Option(help="Of the LV, percent, 0 to 75.")]
RvEjectionFraction = Annotated[float | None, typer.Option(help="Of the RV, percent, 0 to 75.")]
Shortening = Annotated[
    float | None, typer.Option(help="Of apex to base at end-systole, percent, 0 to 30.")
]
Twist = Annotated[
    float | None, typer.Option(help="Apex against base at end-systole, degrees, -40 to 40.")
]


def beat_case(preset: BeatName | None, numbers: Mapping[str, float | None]) -> "Case":
    """The heart of a preset, with those `numbers` that are given: fields of `Beat`, and
    heart_rate_bpm.
    """
    from worker.phantom.beating import PRESETS, BeatPreset, CardiacCycle

    case = PRESETS[BeatPreset((preset or BeatName.HEALTHY).value)]
    given: dict[str, Any] = {name: n for name, n in numbers.items() if n is not None}
    if "heart_rate_bpm" in given:
        given["cycle"] = CardiacCycle(given.pop("heart_rate_bpm"))
    return replace(case, beat=replace(case.beat, **given))


def refuse_without_frames(preset: BeatName | None, numbers: Mapping[str, float | None]) -> None:
    """Raise InputError where a beat is described, and no frames of it are asked for."""
    if preset is not None or any(number is not None for number in numbers.values()):
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "How the heart beats is for a whole beat; add --frames N, such as --frames 25.",
        )
