"""One frame ready to be fitted: what it shows, in mm and in unit coordinates."""

from collections.abc import Mapping
from dataclasses import dataclass

from schemas.vocabulary import Structure
from worker.reconstruction.base_plane import BasePlane
from worker.reconstruction.field_problem import FieldProblem
from worker.reconstruction.normalisation import UnitFrame
from worker.reconstruction.slice_stack import SliceStack


@dataclass(frozen=True, eq=False)
class PosedFrame:
    """bases: where its surfaces are to be cut open, if they are."""

    stack: SliceStack
    unit_frame: UnitFrame
    problem: FieldProblem
    bases: Mapping[Structure, BasePlane]
