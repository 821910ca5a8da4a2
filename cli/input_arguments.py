"""The arguments that `reconstruct` and `submit` share: what they name, and in which words."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from schemas.labels import LabelScheme, Spacing
from schemas.vocabulary import View

_FILE = {"exists": True, "dir_okay": False, "readable": True}
_MAPS = "Label maps"

InputArgument = Annotated[
    Path | None,
    typer.Argument(metavar="INPUT", help="Contour study, or request, as JSON.", **_FILE),
]
OptionsFile = Annotated[
    Path | None, typer.Option("--options", help="JSON file of options.", **_FILE)
]
LabelSchemeText = Annotated[
    str | None,
    typer.Option(
        "--label-scheme",
        help=f"{', '.join(LabelScheme)}, or a JSON object of label values by tissue.",
        rich_help_panel=_MAPS,
    ),
]
SaxFile = Annotated[
    Path | None, typer.Option("--sax", help="NIfTI of the stack.", rich_help_panel=_MAPS, **_FILE)
]
Lax2File = Annotated[
    Path | None, typer.Option("--lax-2ch", help="NIfTI.", rich_help_panel=_MAPS, **_FILE)
]
Lax3File = Annotated[
    Path | None, typer.Option("--lax-3ch", help="NIfTI.", rich_help_panel=_MAPS, **_FILE)
]
Lax4File = Annotated[
    Path | None, typer.Option("--lax-4ch", help="NIfTI.", rich_help_panel=_MAPS, **_FILE)
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
References = Annotated[
    list[str] | None,
    typer.Option(
        "--reference",
        metavar="[SURFACE=]FILE",
        help="Hold a surface against its truth: STL, OBJ or PLY in mm, in the study's axes, as in "
        "ED_lv_endo=truth.ply, or a file called ED_lv_endo. Give it once a surface.",
    ),
]
JsonFlag = Annotated[bool, typer.Option("--json", help="Print one JSON document, for machines.")]


@dataclass(frozen=True)
class LabelArguments:
    """The options of the command line that speak of label maps, as given."""

    scheme: str | None
    sax: Path | None
    lax_2ch: Path | None
    lax_3ch: Path | None
    lax_4ch: Path | None
    subject_id: str
    frame_labels: str | None
    spacing: Spacing

    @property
    def files(self) -> dict[View, Path]:
        given = {
            View.SAX: self.sax,
            View.LAX_2CH: self.lax_2ch,
            View.LAX_3CH: self.lax_3ch,
            View.LAX_4CH: self.lax_4ch,
        }
        return {view: path for view, path in given.items() if path is not None}
