"""What a level of the fit leaves behind for the report."""

from dataclasses import dataclass

from worker.arrays import SomeScalars


@dataclass(frozen=True, eq=False)
class FittedLevel:
    """One level: how many samples were in its mix, and the losses of its iterations, in order."""

    level: int
    samples: int
    bce: SomeScalars
    hinge: SomeScalars
