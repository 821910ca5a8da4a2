"""`holdout.json`: leave-one-slice-out errors beside true ones."""

from benchmarks.results import Environment, Value
from schemas.vocabulary import Structure


class SliceRow(Value):
    """One short-axis slice, means: how far its contours are from the surface fitted without it, and
    the true error of the whole fit between slices, in the half gaps on either side of it.
    """

    held_out_mm: float
    true_mm: float


class SurfaceRow(Value):
    """One surface of one case; means over its short-axis slices' contours, and over its vertices
    between slices. times_plain_fit: what the whole took, in plain reconstructions.
    """

    case: str
    surface: Structure
    slices: int
    times_plain_fit: float
    held_out_mm: float
    true_mm: float
    by_slice: list[SliceRow]


class HoldoutResults(Value):
    """One run."""

    environment: Environment
    surfaces: list[SurfaceRow]
