"""Numbers at the vertices of a surface, as PLY and VTP files hold and explain them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Real

from schemas.problem import InternalError, ProblemType
from worker.artifacts.measured import FIELDS

_LABELS = frozenset({"third", "aha_segment"})
"""Fields that are labels: small whole numbers, written as uint8."""

_UNITS = {"_per_mm2": "1/mm2", "_per_mm": "1/mm", "_mm": "mm"}
"""By how a name ends, the longest first: lengths carry their unit in the name."""


@dataclass(frozen=True, eq=False)
class VertexField:
    """One number a vertex, (n,) float32, or uint8 where it is a label."""

    name: str
    values: np.ndarray

    @property
    def described(self) -> str:
        """Name, unit and meaning in one line: `support_mm [mm]: distance to ...`."""
        unit = next((unit for end, unit in _UNITS.items() if self.name.endswith(end)), None)
        return f"{self.name}{f' [{unit}]' if unit else ''}: {FIELDS[self.name]}"


def vertex_field(name: str, values: Real[np.ndarray, " n"], vertices: int) -> VertexField:
    """A field of `worker.artifacts.measured.FIELDS` at each of so many vertices, ready to write.

    Raises InternalError for a name that is not among them, for a number that is missing, infinite
    or NaN, and for a label that is no whole number from 0 to 255.
    """
    if name not in FIELDS:
        raise _unfit(name, "has no meaning to write beside it; add it to FIELDS")
    if len(values) != vertices:
        raise _unfit(name, f"has {len(values)} numbers for {vertices} vertices; measure each once")
    with np.errstate(over="ignore"):
        single = values.astype(np.float32)
    unknown = int((~np.isfinite(single)).sum())
    if unknown:
        raise _unfit(
            name, f"is not finite at {unknown} vertices; leave out a field not known everywhere"
        )
    if name not in _LABELS:
        return VertexField(name, single)
    labels = np.clip(single, 0, 255).astype(np.uint8)
    if (labels != single).any():
        raise _unfit(name, "is a label, and not a whole number from 0 to 255; round it first")
    return VertexField(name, labels)


def _unfit(name: str, what: str) -> InternalError:
    return InternalError(ProblemType.INTERNAL, f"The vertex field {name} {what}.")
