"""How surfaces are sliced: spacing, views, displacement and the observer's hand."""

from dataclasses import dataclass

from schemas.problem import InputError, ProblemType
from worker.phantom.bounds import require_within


@dataclass(frozen=True)
class SlicingPlan:
    """What the scanner and the observer do. Lengths in mm.

    spacing_mm: between short-axis planes. margin_mm: how far beyond the surfaces planes are still
    made, at most one spacing; such a slice knows its structures to be absent. long_axis_planes:
    0 to 3 (four-, two-, three-chamber). point_spacing_mm: along an outline. shift_sd_mm: standard
    deviation of each in-plane component of a short-axis slice's displacement. noise_sd_mm: of the
    observer's hand, alike over noise_correlation_mm. axis: apex to base (patient axes), if known.
    """

    spacing_mm: float = 8.0
    margin_mm: float = 0.0
    long_axis_planes: int = 3
    point_spacing_mm: float = 1.0
    shift_sd_mm: float = 0.0
    noise_sd_mm: float = 0.0
    noise_correlation_mm: float = 10.0
    axis: tuple[float, float, float] | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        require_within("spacing_mm", self.spacing_mm, 0.5, 50.0)
        require_within("margin_mm", self.margin_mm, 0.0, self.spacing_mm)
        require_within("long_axis_planes", float(self.long_axis_planes), 0.0, 3.0)
        require_within("point_spacing_mm", self.point_spacing_mm, 0.1, 10.0)
        require_within("shift_sd_mm", self.shift_sd_mm, 0.0, 20.0)
        require_within("noise_sd_mm", self.noise_sd_mm, 0.0, 5.0)
        require_within("noise_correlation_mm", self.noise_correlation_mm, 1.0, 100.0)
        if self.axis is not None and not any(self.axis):
            raise InputError(
                ProblemType.INVALID_REQUEST,
                "axis is the zero vector; give the direction from apex to base.",
                pointer="/axis",
            )


STANDARD_PLAN = SlicingPlan()
"""8 mm short-axis spacing and three long-axis planes, no displacement, no noise."""
