"""The contour study: what a clinical pipeline sends, planar contours in patient space."""

from collections import Counter
from collections.abc import Iterable
from typing import Annotated, Self

from pydantic import FailFast, Field, model_validator

from schemas.base import Name, WireModel
from schemas.vocabulary import Axes, Structure, Units, View

Coordinate = Annotated[float, Field(ge=-1e7, le=1e7)]
Point = tuple[Coordinate, Coordinate, Coordinate]

# Long lists stop at their first fault: a million faults would cost gigabytes to report.


class Contour(WireModel):
    """One outline of one structure on a slice, in the study's units and axes.

    A closed contour's last point joins its first; do not repeat the first point. An open contour
    (long-axis views are open at the valves) is closed by a chord that is not an observed boundary.
    """

    structure: Structure
    closed: bool = True
    points: Annotated[list[Point], FailFast()] = Field(
        min_length=3, description="Points x, y, z along the outline."
    )


class Slice(WireModel):
    """One image plane and what was outlined on it.

    A structure with contours here is observed; one in `absent` is known to be outside on the whole
    plane; any other is unknown here and says nothing.
    """

    id: Name
    view: View = View.OTHER
    origin: Point | None = Field(
        default=None, description="Any point of the plane. Left out, the plane is fitted."
    )
    normal: Point | None = Field(
        default=None, description="The plane's normal, of any length but zero."
    )
    contours: Annotated[list[Contour], FailFast()] = Field(default_factory=list)
    absent: list[Structure] = Field(default_factory=list, max_length=len(Structure))

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        if (self.origin is None) != (self.normal is None):
            raise ValueError("give both `origin` and `normal`, or neither to have the plane fitted")
        if not self.contours and not self.absent:
            raise ValueError(
                "the slice says nothing; give contours, or list the structures known to be absent"
            )
        if not self.contours and self.origin is None:
            raise ValueError("a slice without contours needs `origin` and `normal`")
        if self.normal is not None and not any(self.normal):
            raise ValueError("`normal` is the zero vector; give the plane's direction")
        both = sorted({c.structure for c in self.contours} & set(self.absent))
        if both:
            raise ValueError(f"{', '.join(both)} has contours here and is listed absent; keep one")
        return self


class Frame(WireModel):
    """One instant of the cardiac cycle."""

    label: Name
    time_ms: float | None = Field(default=None, ge=0.0, le=1e5)
    slices: Annotated[list[Slice], FailFast()] = Field(min_length=1)

    @model_validator(mode="after")
    def _has_unique_slices(self) -> Self:
        _refuse_repeats("slice id", (s.id for s in self.slices))
        return self


class ContourStudy(WireModel):
    """Every frame of one subject: the native input of a reconstruction."""

    subject_id: Name
    units: Units
    axes: Axes
    frames: Annotated[list[Frame], FailFast()] = Field(min_length=1)

    @model_validator(mode="after")
    def _has_unique_frames(self) -> Self:
        _refuse_repeats("frame label", (f.label for f in self.frames))
        return self


def _refuse_repeats(what: str, names: Iterable[str]) -> None:
    """Names become file names, so two that differ only in case are the same name."""
    repeats = sorted(name for name, n in Counter(n.lower() for n in names).items() if n > 1)
    if repeats:
        raise ValueError(f"{what} used more than once: {', '.join(repeats)}; make them unique")
