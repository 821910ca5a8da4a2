"""What a method returns for one frame, and its way through a file from one process to another."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from schemas.vocabulary import Structure
from worker.arrays import Vector
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True, eq=False)
class Found:
    """Surfaces of one frame, patient frame, mm.

    shifts_mm: by slice id the displacement (3,) that was found; empty for a method that looks for
    none. failures: why a surface is missing.
    """

    surfaces: Mapping[Structure, SurfaceMesh]
    shifts_mm: Mapping[str, Vector] = field(default_factory=dict)
    failures: Mapping[Structure, str] = field(default_factory=dict)


def save(found: Found, file: Path) -> None:
    """Write to a `.npz` file."""
    arrays: dict[str, np.ndarray] = {}
    for structure, mesh in found.surfaces.items():
        arrays[f"vertices_mm:{structure}"] = mesh.vertices_mm
        arrays[f"faces:{structure}"] = mesh.faces
    for slice_id, shift in found.shifts_mm.items():
        arrays[f"shift_mm:{slice_id}"] = shift
    for structure, reason in found.failures.items():
        arrays[f"failure:{structure}"] = np.array(reason)
    np.savez(file, allow_pickle=False, **arrays)


def load(file: Path) -> Found:
    """Read what `save` wrote."""
    with np.load(file) as arrays:
        by_kind: dict[str, dict[str, np.ndarray]] = {}
        for key in arrays.files:
            kind, _, name = key.partition(":")
            by_kind.setdefault(kind, {})[name] = arrays[key]
    faces = by_kind.get("faces", {})
    return Found(
        {
            Structure(name): SurfaceMesh(vertices, faces[name])
            for name, vertices in by_kind.get("vertices_mm", {}).items()
        },
        by_kind.get("shift_mm", {}),
        {Structure(name): str(reason) for name, reason in by_kind.get("failure", {}).items()},
    )
