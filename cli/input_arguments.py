"""Arguments that commands share beside those of label maps: what they name, in which words."""

from pathlib import Path
from typing import Annotated

import typer

FILE = {"exists": True, "dir_okay": False, "readable": True}
"""Of an argument that names a file which has to be there."""

InputArgument = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="INPUT...",
        help="Contour study, or request, as JSON; or contour files of another program, or a folder "
        "of them: see `neuralmri convert`.",
        exists=True,
        readable=True,
    ),
]
FormatSettings = Annotated[
    Path | None,
    typer.Option(
        "--format-settings",
        help="JSON file of what contour files do not say, as in "
        '{"guide_points": {"rr_interval_ms": 857}}.',
        **FILE,
    ),
]
OptionsFile = Annotated[
    Path | None, typer.Option("--options", help="JSON file of options.", **FILE)
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
