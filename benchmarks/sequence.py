"""What it costs and gains to fit the frames of a cycle from each other.

    python -m benchmarks.sequence [SURFACES.npz] [--frames N] [--noise MM] [--shift MM]

SURFACES.npz has `vertices` (frames, n, 3) in mm, `faces` (m, 3) and `materials` (m,) of a whole
cycle, as the reference surfaces of the guide points have. Without it, the phantom beats. Every mode
is one reconstruction of the same slices; prints one row a mode, and one a frame.
"""

import argparse
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from trimesh import Trimesh

from schemas.options import Options
from schemas.vocabulary import Structure
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.size import volume_ml
from worker.phantom.analytic_heart import heart
from worker.phantom.slicing import slice_frames
from worker.phantom.slicing_plan import SlicingPlan
from worker.reconstruction.pipeline import reconstruct
from worker.surface_mesh import SurfaceMesh
from worker.threads import bind_libraries, use_threads

Surfaces = Mapping[Structure, SurfaceMesh]

_MATERIALS = {
    Structure.LV_ENDO: ("LV_ENDOCARDIAL", "AORTA_VALVE", "MITRAL_VALVE"),
    Structure.LV_EPI: (
        "LV_EPICARDIAL", "AORTA_VALVE", "AORTA_VALVE_CUT", "MITRAL_VALVE", "MITRAL_VALVE_CUT",
        "RV_SEPTUM", "THRU_WALL",
    ),
    Structure.RV_ENDO: ("RV_FREEWALL", "PULMONARY_VALVE", "RV_SEPTUM", "TRICUSPID_VALVE"),
}  # fmt: skip
"""Pieces that make each surface closed."""

MODES = {
    "every frame from nothing": {"warm_start": False, "share_shifts": False},
    "shifts shared": {"warm_start": False},
    "from neighbours, shifts shared": {},
}


@dataclass(frozen=True)
class Row:
    """distances_mm: (frames, surfaces) means, both ways. volumes_ml: (frames, surfaces)."""

    distances_mm: np.ndarray
    volumes_ml: np.ndarray
    cpu_s: float
    wall_s: float


def surfaces_of(path: Path) -> list[Surfaces]:
    """The closed surfaces of every frame, facing outward."""
    with np.load(path) as held:
        vertices, faces, materials = held["vertices"], held["faces"], held["materials"]
    pieces = {}
    for structure, names in _MATERIALS.items():
        chosen = faces[np.isin(materials, names)]
        shell = Trimesh(vertices[0].astype(float), chosen, process=False)
        shell.fix_normals()
        used, renumbered = np.unique(np.asarray(shell.faces), return_inverse=True)
        pieces[structure] = used, renumbered.reshape(-1, 3)
    return [
        {s: SurfaceMesh(frame[used].astype(float), f) for s, (used, f) in pieces.items()}
        for frame in vertices
    ]


def beating(frames: int) -> list[Surfaces]:
    """The phantom over a cycle of so many frames, end-diastole first."""
    phases = 0.5 * (1.0 - np.cos(2.0 * np.pi * np.arange(frames) / frames))
    return [heart(float(phase)).meshes(1.5) for phase in phases]


def measured(truth: Sequence[Surfaces], plan: SlicingPlan, options: Options) -> Row:
    """One reconstruction of the whole cycle, sliced as planned."""
    study = slice_frames({f"F{k:02d}": one for k, one in enumerate(truth)}, plan).study
    start, used = time.perf_counter(), time.process_time()
    found = reconstruct(study, options).frames
    wall_s, cpu_s = time.perf_counter() - start, time.process_time() - used
    distances = [
        [surface_to_surface(one.surfaces[s], at[s]).mean_mm for s in at]
        for one, at in zip(found, truth, strict=True)
    ]
    volumes = [
        [volume_ml(one.surfaces[s]) for s in at] for one, at in zip(found, truth, strict=True)
    ]
    return Row(np.array(distances), np.array(volumes), cpu_s, wall_s)


def jitter_ml(volumes_ml: np.ndarray) -> np.ndarray:
    """Root mean square of the second differences over a whole cycle, by surface."""
    around = np.concatenate([volumes_ml[-1:], volumes_ml, volumes_ml[:1]])
    jitter: np.ndarray = np.sqrt((np.diff(around, 2, axis=0) ** 2).mean(axis=0))
    return jitter


def ejection_fraction(volumes_ml: np.ndarray) -> float:
    """Percent, by the largest and smallest volume of the first surface."""
    cavity = volumes_ml[:, 0]
    return float(100.0 * (cavity.max() - cavity.min()) / cavity.max())


def main() -> None:
    """Measure every mode, and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("surfaces", type=Path, nargs="?")
    parser.add_argument("--frames", type=int, default=9, help="of the cycle, evenly spread")
    parser.add_argument("--noise", type=float, default=0.0, metavar="MM")
    parser.add_argument("--shift", type=float, default=0.0, metavar="MM")
    arguments = parser.parse_args()
    bind_libraries(1)
    use_threads(1)
    truth = beating(arguments.frames)
    if arguments.surfaces:
        every = surfaces_of(arguments.surfaces)
        chosen = np.unique(np.linspace(0, len(every), arguments.frames, endpoint=False).astype(int))
        truth = [every[k] for k in chosen]
    true_ml = np.array([[volume_ml(one[s]) for s in one] for one in truth])
    names = " / ".join(truth[0])
    print(f"mean mm, jitter of volume errors mL, each {names}; EF %; CPU and wall s a frame")
    print(f"truth: EF {ejection_fraction(true_ml):.1f}, its own jitter {_said(jitter_ml(true_ml))}")
    rows = {}
    plan = SlicingPlan(noise_sd_mm=arguments.noise, shift_sd_mm=arguments.shift)
    for name, mode in MODES.items():
        row = rows[name] = measured(truth, plan, Options.model_validate({"sequence": mode}))
        frames = len(truth)
        print(
            f"{name}: {_said(row.distances_mm.mean(axis=0))}, "
            f"{_said(jitter_ml(row.volumes_ml - true_ml))}; "
            f"{ejection_fraction(row.volumes_ml):.1f}; "
            f"{row.cpu_s / frames:.1f} and {row.wall_s / frames:.1f}",
            flush=True,
        )
    for frame in range(len(truth)):
        by_mode = "; ".join(_said(row.distances_mm[frame]) for row in rows.values())
        print(f"frame {frame}: {by_mode}")


def _said(values: np.ndarray) -> str:
    return " / ".join(f"{value:.2f}" for value in values)


if __name__ == "__main__":
    main()
