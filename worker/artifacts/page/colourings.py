"""The ways to colour a frame's surfaces: one for each field that is known at their vertices."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from worker.arrays import SomeFaces, SomeScalars
from worker.artifacts.measured import FIELDS
from worker.artifacts.page.colour_scales import (
    AMOUNT,
    ERROR,
    SIGNED,
    robust_range,
    scale_of_amounts,
    scale_of_kinds,
    segment_colours,
)
from worker.artifacts.page.typed_arrays import typed


@dataclass(frozen=True)
class _Look:
    """How a field is called and coloured. kind: colours of a range; names, colours: of kinds."""

    label: str
    unit: str
    kind: Sequence[str] = ()
    names: Sequence[str] = ()
    colours: Callable[[], Sequence[str]] = tuple


_LOOKS: Mapping[str, _Look] = {
    "residual_mm": _Look("contour residual", "mm", ERROR),
    "distance_mm": _Look("distance to the reference", "mm", ERROR),
    "deviation_mm": _Look("deviation over the ensemble", "mm", ERROR),
    "support_mm": _Look("support", "mm", ERROR),
    "mean_curvature_per_mm": _Look("mean curvature", "1/mm", SIGNED),
    "gaussian_curvature_per_mm2": _Look("Gaussian curvature", "1/mm²", SIGNED),
    "thickness_mm": _Look("wall thickness", "mm", AMOUNT),
    "area_strain": _Look("area strain", "", SIGNED),
    "third": _Look(
        "third",
        "",
        names=("apex", "mid", "base"),
        colours=lambda: ("#b5332f", "#e9b44c", "#3b7ea1"),
    ),
    "aha_segment": _Look(
        "AHA segment", "", names=("0", *(str(n) for n in range(1, 18))), colours=segment_colours
    ),
}
"""In the order of the menu."""

_ENDS: Mapping[Sequence[str], str] = {
    ERROR: "Colours end at the 95th percentile.",
    AMOUNT: "Colours end at the 5th and 95th percentile.",
    SIGNED: "Colours end at the 5th or 95th percentile, whichever is further from 0.",
}


@dataclass(frozen=True, eq=False)
class Shown:
    """A surface as it is drawn: its trace's number, its faces and its fields, (vertices,) each."""

    trace: int
    faces: SomeFaces
    fields: Mapping[str, SomeScalars]


def colourings(surfaces: Sequence[Shown]) -> list[dict[str, Any]]:
    """One for each field that some surface has: `label`, `hint`, plotly's `coloraxis`, whether
    numbers belong to vertices or to cells (`mode`), and `values` by the number of the trace.
    """
    names = [name for name in _LOOKS if any(name in one.fields for one in surfaces)]
    return [_colouring(name, _LOOKS[name], surfaces) for name in names]


def _colouring(name: str, look: _Look, surfaces: Sequence[Shown]) -> dict[str, Any]:
    having = [one for one in surfaces if name in one.fields]
    title = f"{look.label}, {look.unit}" if look.unit else look.label
    hint = f"{name}: {FIELDS[name]}."
    if look.names:
        axis = scale_of_kinds(look.names, look.colours())
        values = {str(one.trace): typed(_of_cells(one, name), "u1") for one in having}
        mode = "cell"
    else:
        everything = np.concatenate([one.fields[name] for one in having])
        gaps = not bool(np.isfinite(everything).all())
        low, high = robust_range(everything, kind=look.kind)
        axis, nothing = scale_of_amounts(low, high, look.kind, gaps=gaps)
        values = {
            str(one.trace): typed(_filled(one.fields[name], low, nothing, gaps=gaps))
            for one in having
        }
        mode = "vertex"
        hint += " " + _ENDS[look.kind] + (" Grey: not known there." if gaps else "")
    return {
        "name": name,
        "label": look.label,
        "unit": look.unit,
        "title": title,
        "hint": hint,
        "coloraxis": axis,
        "mode": mode,
        "values": values,
    }


def _filled(values: SomeScalars, low: float, nothing: float, *, gaps: bool) -> SomeScalars:
    """Grey lies below the range: what is merely low must not fall into it."""
    return np.where(np.isfinite(values), np.maximum(values, low), nothing) if gaps else values


def _of_cells(one: Shown, name: str) -> np.ndarray:
    """Kinds are not blended across a triangle: it has the middle one of its corners."""
    return np.median(np.nan_to_num(one.fields[name])[one.faces], axis=1)
