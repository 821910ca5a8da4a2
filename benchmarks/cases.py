"""What is reconstructed: phantoms that vary one factor at a time, and folders with references."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.arrays import Vector
from worker.mesh_file import read_surface
from worker.phantom import SlicingPlan, heart, slice_meshes
from worker.surface_mesh import SurfaceMesh

STANDARD = SlicingPlan(
    spacing_mm=8.0, long_axis_planes=3, shift_sd_mm=0.0, noise_sd_mm=0.0, margin_mm=0.0
)
"""The protocol that the others are held against."""

FACTORS: Mapping[str, tuple[float, ...]] = {
    "spacing_mm": (6.0, 8.0, 10.0, 12.0),
    "long_axis_planes": (0, 1, 2, 3),
    "shift_sd_mm": (0.0, 1.5, 3.0),
    "noise_sd_mm": (0.0, 0.5, 1.0),
}
"""Each is varied while the others stay at the standard."""

POOREST = replace(STANDARD, spacing_mm=10.0, long_axis_planes=0, shift_sd_mm=3.0)
"""Several at once: a wide stack, no long-axis slice, displaced breath-holds."""


@dataclass(frozen=True, eq=False)
class Case:
    """A study with one frame, and the surfaces it was cut from.

    plan: how a phantom was sliced, None for a folder. true_shifts_mm: by slice id the displacement
    (3,) that was added to its contours; empty where slices are in place.
    """

    name: str
    study: ContourStudy
    truth: Mapping[Structure, SurfaceMesh]
    plan: SlicingPlan | None = None
    true_shifts_mm: Mapping[str, Vector] = field(default_factory=dict)


def protocols() -> list[SlicingPlan]:
    """Every plan once: each factor's values, the standard among them, and the poorest."""
    changes: list[dict[str, Any]] = [{name: v} for name, values in FACTORS.items() for v in values]
    return list(dict.fromkeys([*(replace(STANDARD, **c) for c in changes), POOREST]))


def plan_name(plan: SlicingPlan) -> str:
    """A plan in words: `phantom 8 mm 3 LAX`, and shifts or noise where there are some."""
    parts = [f"phantom {plan.spacing_mm:g} mm {plan.long_axis_planes} LAX"]
    if plan.shift_sd_mm:
        parts.append(f"shift {plan.shift_sd_mm:g} mm")
    if plan.noise_sd_mm:
        parts.append(f"noise {plan.noise_sd_mm:g} mm")
    return " ".join(parts)


def factors(plan: SlicingPlan) -> dict[str, float]:
    """The varied numbers of a plan, by name."""
    return {f.name: getattr(plan, f.name) for f in fields(plan) if f.name in FACTORS}


def phantoms(only: tuple[str, ...] = ()) -> Iterator[Case]:
    """The standard heart at end-diastole under every protocol; `only` those whose name has one."""
    chosen = [plan for plan in protocols() if is_chosen(plan_name(plan), only)]
    truth = heart(0.0).meshes(1.0) if chosen else {}
    for plan in chosen:
        sliced = slice_meshes(truth, plan)
        shifts = sliced.true_shifts_mm if plan.shift_sd_mm else {}
        yield Case(plan_name(plan), sliced.study, truth, plan, shifts)


def folders(root: Path, only: tuple[str, ...] = ()) -> Iterator[Case]:
    """Every `contours.json` with `reference/{surface}.ply` in a folder below `root`."""
    for study_file in sorted(root.glob("*/contours.json")):
        folder = study_file.parent
        if not is_chosen(folder.name, only):
            continue
        shifts_file = folder / "true_shifts_mm.json"
        shifts = json.loads(shifts_file.read_text()) if shifts_file.is_file() else {}
        yield Case(
            folder.name,
            ContourStudy.model_validate_json(study_file.read_bytes()),
            {Structure(p.stem): read_surface(p) for p in sorted(folder.glob("reference/*.ply"))},
            None,
            {slice_id: np.array(shift) for slice_id, shift in shifts.items()},
        )


def is_chosen(name: str, only: tuple[str, ...]) -> bool:
    """Whether a name holds one of the words asked for; all do when none is."""
    return not only or any(word in name for word in only)
