"""`neuralmri convert`: contour files of one program in, those of another out."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import notice_console, say, say_json
from cli.input_arguments import FormatSettings, JsonFlag
from cli.inputs import read_contours
from cli.study_file import write_study

if TYPE_CHECKING:
    from intake.formats.exported import Exported
    from schemas.study import ContourStudy


class Target(StrEnum):
    """What is written."""

    STUDY = "study"
    """One JSON file, the native format."""
    GUIDE_POINTS = "guide-points"
    CSL = "csl"
    RTSTRUCT = "rtstruct"


def convert(
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="INPUT...",
            help="Contour study as JSON, or contour files, or a folder of them, of one subject: "
            "guide points (GPFile*.txt, SliceInfoFile.txt), cross-sections (.csl), DICOM "
            "RTSTRUCT or a cvi42 workspace with its images' headers or geometry table.",
            exists=True,
            readable=True,
        ),
    ],
    out: Annotated[Path, typer.Option(help="File of the study, or folder of the files.")],
    to: Annotated[Target, typer.Option(help="Format to write.")] = Target.STUDY,
    subject_id: Annotated[str, typer.Option(help="Name of the subject.")] = "subject",
    format_settings: FormatSettings = None,
    as_json: JsonFlag = False,
) -> None:
    """Read one subject's contours, in whatever format, and write them in another.

    The format of the input is told by its content. What had to be guessed, mended or left out is
    said.
    """
    given = read_contours(inputs, subject_id, None, format_settings)
    study, warnings = given.request.study, list(given.request.warnings)
    if to is Target.STUDY:
        write_study(out, study)
        written = [out]
    else:
        exported = _exported(study, to)
        warnings += exported.warnings
        out.mkdir(parents=True, exist_ok=True)
        written = [out / name for name in exported.files]
        for name, content in exported.files.items():
            (out / name).write_bytes(content)
    if as_json:
        say_json({"files": [str(path) for path in written], "warnings": warnings})
        return
    for warning in warnings:
        notice_console.print(f"warning: {warning}", markup=False, soft_wrap=True)
    slices = sum(len(frame.slices) for frame in study.frames)
    where = str(out) if len(written) == 1 else f"{len(written)} files in {out}"
    say(f"{len(study.frames)} frames, {slices} slices: {where}")


def _exported(study: "ContourStudy", to: Target) -> "Exported":
    from intake.formats.csl_out import write_csl
    from intake.formats.exported import Exported
    from intake.formats.guide_points_out import write_guide_points
    from intake.formats.rtstruct_writing import write_rtstruct

    if to is Target.RTSTRUCT:
        files = {f"{label}.dcm": content for label, content in write_rtstruct(study).items()}
        return Exported(files, ("what is absent from a slice is not written: no place for it",))
    return write_csl(study) if to is Target.CSL else write_guide_points(study)
