"""Accuracy and speed side by side: every preset and the classical baseline, in one run.

    python -m benchmarks.accuracy [--cases DIR] > docs/benchmarks.md

Phantoms at several protocols, and every case of DIR: a folder `contours.json` and
`reference/{surface}.ply`. Distances are exact, point to triangle, both ways.
"""

import argparse
import platform
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import torch

from benchmarks.shape_based import shape_based
from cli.mesh_file import read_surface
from schemas.options import Options, Preset
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.size import volume_ml
from worker.phantom import SlicingPlan, heart, slice_meshes
from worker.reconstruction.pipeline import reconstruct
from worker.reconstruction.stacking import build_stack
from worker.surface_mesh import SurfaceMesh

Meshes = dict[Structure, SurfaceMesh]


@dataclass(frozen=True)
class Case:
    """A study with one frame, and the surfaces it was cut from."""

    name: str
    study: ContourStudy
    truth: Meshes


def phantoms() -> Iterator[Case]:
    """The standard heart at end-diastole under protocols from generous to poor."""
    truth = heart(0.0).meshes(1.0)
    for spacing_mm, long_axis_planes, shift_sd_mm in (
        (8.0, 3, 0.0),
        (10.0, 3, 0.0),
        (10.0, 1, 0.0),
        (10.0, 0, 0.0),
        (10.0, 3, 1.5),
        (10.0, 3, 3.0),
        (10.0, 0, 3.0),
    ):
        plan = SlicingPlan(
            spacing_mm=spacing_mm, long_axis_planes=long_axis_planes, shift_sd_mm=shift_sd_mm
        )
        name = f"phantom, {spacing_mm:g} mm, {long_axis_planes} LAX, shifts {shift_sd_mm:g} mm"
        yield Case(name, slice_meshes(truth, plan).study, truth)


def cases(folder: Path) -> Iterator[Case]:
    """Every case below `folder`."""
    for study_file in sorted(folder.glob("*/contours.json")):
        study = ContourStudy.model_validate_json(study_file.read_bytes())
        references = study_file.parent / "reference"
        truth = {Structure(p.stem): read_surface(p) for p in sorted(references.glob("*.ply"))}
        yield Case(study_file.parent.name, study, truth)


def by_field(study: ContourStudy, preset: Preset) -> Meshes:
    """Surfaces of the first frame by this project's fit."""
    return dict(reconstruct(study, Options(preset=preset)).frames[0].surfaces)


def by_interpolation(study: ContourStudy) -> Meshes:
    """Surfaces of the first frame by shape-based interpolation."""
    stack = build_stack(study, study.frames[0])
    return {s: shape_based(stack, s) for s in sorted(stack.observed)}


def rows(case: Case) -> Iterator[str]:
    """One table row a method."""
    for preset in Preset:
        yield _row(case, f"field, {preset}", partial(by_field, case.study, preset))
    yield _row(case, "shape-based", partial(by_interpolation, case.study))


def _row(case: Case, method: str, compute: Callable[[], Meshes]) -> str:
    start = time.perf_counter()
    found = compute()
    seconds = time.perf_counter() - start
    cells = []
    for structure, truth in case.truth.items():
        distance = surface_to_surface(found[structure], truth)
        off = 100.0 * (volume_ml(found[structure]) / volume_ml(truth) - 1.0)
        cells.append(
            f"{distance.mean_mm:.2f} / {distance.hausdorff95_mm:.2f} / "
            f"{distance.hausdorff_mm:.1f} / {off:+.1f}"
        )
    return f"| {case.name} | {method} | {' | '.join(cells)} | {seconds:.1f} |"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=Path, help="folder of cases with references")
    folder = parser.parse_args().cases
    torch.set_num_threads(1)
    print("# Benchmarks\n")
    print(
        f"One run of `python -m benchmarks.accuracy`, one thread, {platform.machine()}, "
        f"Python {platform.python_version()}, torch {torch.__version__}, numpy {np.__version__}. "
        "Per surface: mean distance / larger directed 95th percentile / maximum, mm / volume "
        "error, %. Seconds are wall time, the fit and the meshing.\n"
    )
    print("| case | method | lv_endo | lv_epi | rv_endo | s |\n|---|---|---|---|---|---|")
    studied = [phantoms()] + ([cases(folder)] if folder else [])
    for source in studied:
        for case in source:
            for row in rows(case):
                print(row, flush=True)
                print(row, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
