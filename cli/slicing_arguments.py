"""The arguments that `slice` and `phantom` share: how surfaces are cut into contours."""

from typing import Annotated

import typer

SliceSpacing = Annotated[float, typer.Option(help="Between short-axis slices, mm.")]
Margin = Annotated[float, typer.Option(help="Slices this far beyond the surfaces, all absent, mm.")]
LongAxisSlices = Annotated[int, typer.Option(help="Long-axis slices: 0 to 3 (4ch, 2ch, 3ch).")]
PointSpacing = Annotated[float, typer.Option(help="Between points of a contour, mm.")]
ShiftDeviation = Annotated[
    float, typer.Option(help="In-plane displacement of short-axis slices, SD, mm.")
]
NoiseDeviation = Annotated[float, typer.Option(help="Unsteadiness of the contours, SD, mm.")]
SubjectId = Annotated[str, typer.Option(help="Name of the subject.")]
Seed = Annotated[int, typer.Option(help="Seed of displacement and noise.", min=0)]
