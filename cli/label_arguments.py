"""The arguments that speak of label maps: the same in every command that takes a subject."""

import inspect
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

import typer

from cli.input_arguments import FILE
from schemas.labels import LabelScheme, Spacing
from schemas.vocabulary import View

_MAPS = "Label maps"
_PARAMETER = "maps"

LabelSchemeText = Annotated[
    str | None,
    typer.Option(
        "--label-scheme",
        help=f"{', '.join(LabelScheme)}, or a JSON object of label values by tissue.",
        rich_help_panel=_MAPS,
    ),
]
SaxFile = Annotated[
    Path | None, typer.Option("--sax", help="NIfTI of the stack.", rich_help_panel=_MAPS, **FILE)
]
Lax2File = Annotated[
    Path | None, typer.Option("--lax-2ch", help="NIfTI.", rich_help_panel=_MAPS, **FILE)
]
Lax3File = Annotated[
    Path | None, typer.Option("--lax-3ch", help="NIfTI.", rich_help_panel=_MAPS, **FILE)
]
Lax4File = Annotated[
    Path | None, typer.Option("--lax-4ch", help="NIfTI.", rich_help_panel=_MAPS, **FILE)
]
SubjectId = Annotated[
    str, typer.Option("--subject-id", help="Name in the report.", rich_help_panel=_MAPS)
]
FrameLabels = Annotated[
    str | None,
    typer.Option("--frame-labels", help="One name a frame, e.g. ED,ES.", rich_help_panel=_MAPS),
]
SpacingChoice = Annotated[
    Spacing,
    typer.Option("--spacing", help="Whom to believe about the voxel size.", rich_help_panel=_MAPS),
]


@dataclass(frozen=True)
class LabelArguments:
    """What was given; each field is an option of the command line."""

    scheme: LabelSchemeText = None
    sax: SaxFile = None
    lax_2ch: Lax2File = None
    lax_3ch: Lax3File = None
    lax_4ch: Lax4File = None
    subject_id: SubjectId = "subject"
    frame_labels: FrameLabels = None
    spacing: SpacingChoice = Spacing.AUTO

    @property
    def files(self) -> dict[View, Path]:
        given = {
            View.SAX: self.sax,
            View.LAX_2CH: self.lax_2ch,
            View.LAX_3CH: self.lax_3ch,
            View.LAX_4CH: self.lax_4ch,
        }
        return {view: path for view, path in given.items() if path is not None}


def takes_label_maps(
    without: tuple[str, ...] = (),
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Make a command whose parameter `maps` is one LabelArguments take an option for each field.

    `without` names fields that the command knows by itself; they have their defaults in `maps`.
    """
    options = [
        inspect.Parameter(
            field.name,
            inspect.Parameter.POSITIONAL_OR_KEYWORD,
            default=field.default,
            annotation=field.type,
        )
        for field in fields(LabelArguments)
        if field.name not in without
    ]

    def widen(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def run(**given: Any) -> None:
            maps = LabelArguments(**{option.name: given.pop(option.name) for option in options})
            command(maps=maps, **given)

        own = inspect.signature(command)
        parameters: list[inspect.Parameter] = []
        for name, parameter in own.parameters.items():
            parameters += options if name == _PARAMETER else [parameter]
        # Typer reads both: order and defaults from the one, types from the other.
        widened: Any = run
        widened.__signature__ = own.replace(parameters=parameters)
        widened.__annotations__ = {one.name: one.annotation for one in parameters}
        return run

    return widen
