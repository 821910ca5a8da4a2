"""The answer to a study that was judged and not kept."""

from typing import Literal

from pydantic import Field

from schemas.base import WireModel
from schemas.vocabulary import Structure


class Validation(WireModel):
    """A submission that would be accepted. One that would not be is answered by its problem."""

    valid: Literal[True] = True
    surfaces: dict[str, list[Structure]] | None = Field(
        description="The surfaces that the job would make, by frame. null for label maps: a worker "
        "reads their voxels."
    )
    warnings: list[str] = Field(description="What the report would warn about.")
    effort_fits: float | None = Field(
        ge=0.0,
        description="How much work the job would be, counted in plain fits of one frame. For label "
        "maps at most that, and null with `holdout`: a worker counts the slices.",
    )
