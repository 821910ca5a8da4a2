"""What leave-one-slice-out says about the error between slices, beside the true one.

    python -m benchmarks.holdout [--cases DIR] [--only WORD] [--out docs/benchmarks]

Every case is reconstructed by the standard preset with `holdout: leave_one_slice_out`, two cases at
a time, each on one thread. Writes holdout.json; progress goes to stderr.
"""

import argparse
import itertools
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from benchmarks.cases import Case, folders, phantoms
from benchmarks.environment import environment
from benchmarks.holdout_results import HoldoutResults, SliceRow, SurfaceRow
from benchmarks.measure import ROOT
from schemas.options import Holdout, Options
from schemas.vocabulary import Structure, View
from worker.arrays import Points, Scalars, Vector
from worker.artifacts.evidence import aligned_outlines
from worker.artifacts.held_out import HeldOut, held_out_distances
from worker.evaluation.distance import points_to_surface_mm
from worker.evaluation.extrapolation import apex_to_base, slice_gap_mm
from worker.evaluation.support import AlignedOutline, distance_to_outlines_mm
from worker.reconstruction.pipeline import reconstruct
from worker.reconstruction.result import FrameFit
from worker.surface_mesh import SurfaceMesh
from worker.threads import bind_libraries, use_threads

_BETWEEN = 0.25
"""Of a slice gap: what is further than this from every contour lies between slices."""

_FEWEST = 50
"""Vertices between slices about one slice, fewer of which give no mean."""


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.holdout", description=__doc__)
    parser.add_argument("--cases", type=Path, metavar="DIR", help="folder of cases with references")
    parser.add_argument("--only", action="append", default=[], metavar="WORD")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "benchmarks", metavar="DIR")
    arguments = parser.parse_args()
    only = tuple(arguments.only)
    where = environment()
    bind_libraries(1)
    given = folders(arguments.cases, only) if arguments.cases else iter(())
    cases = itertools.chain(phantoms(only), given)
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        rows = [row for some in pool.map(surface_rows, cases) for row in some]
    results = HoldoutResults(environment=where, surfaces=rows)
    arguments.out.mkdir(parents=True, exist_ok=True)
    text = results.model_dump_json(indent=1, exclude_none=True)
    (arguments.out / "holdout.json").write_text(text + "\n")


def surface_rows(case: Case, options: Options | None = None) -> list[SurfaceRow]:
    """One row a surface that has a truth, short-axis slices, and more than one slice to leave out.

    options: of the fit; the standard preset when None.
    """
    use_threads(1)
    asked = options or Options()
    started = time.perf_counter()
    reconstruct(case.study, asked)
    fitted = time.perf_counter()
    again = asked.model_copy(update={"holdout": Holdout.LEAVE_ONE_SLICE_OUT})
    frame = reconstruct(case.study, again).frames[0]
    refitted = time.perf_counter()
    times = (refitted - fitted) / (fitted - started)
    print(f"{case.name} | {times:.1f} times the plain fit", file=sys.stderr, flush=True)
    return list(_rows(case, frame, times))


def _rows(case: Case, frame: FrameFit, times: float) -> Iterator[SurfaceRow]:
    outlines = aligned_outlines(frame)
    toward_base = apex_to_base(outlines)
    if toward_base is None:
        return
    held_out = held_out_distances(frame, outlines)
    for structure, truth in case.truth.items():
        across = [one for one in held_out.get(structure, ()) if one.view is View.SAX]
        gap_mm = slice_gap_mm(toward_base, outlines.get(structure, ()))
        if not across or gap_mm is None:
            continue
        between = _between(frame.surfaces[structure], outlines[structure], truth, gap_mm)
        yield SurfaceRow(
            case=case.name,
            surface=structure,
            slices=len(across),
            times_plain_fit=times,
            held_out_mm=float(np.concatenate([one.distances_mm for one in across]).mean()),
            true_mm=float(between.distances_mm.mean()),
            by_slice=_by_slice(across, outlines, structure, between, toward_base, gap_mm),
        )


@dataclass(frozen=True, eq=False)
class _Between:
    """Vertices (n, 3) of a surface that lie between slices, and their distances (n,) to the truth,
    mm.
    """

    points_mm: Points
    distances_mm: Scalars


def _between(
    mesh: SurfaceMesh, outlines: Sequence[AlignedOutline], truth: SurfaceMesh, gap_mm: float
) -> _Between:
    support_mm = distance_to_outlines_mm(mesh.vertices_mm, outlines)
    points_mm = mesh.vertices_mm[support_mm > _BETWEEN * gap_mm]
    return _Between(points_mm, points_to_surface_mm(points_mm, truth))


def _by_slice(
    across: Sequence[HeldOut],
    outlines: Mapping[Structure, Sequence[AlignedOutline]],
    structure: Structure,
    between: _Between,
    toward_base: Vector,
    gap_mm: float,
) -> list[SliceRow]:
    """Each slice's own error when left out, and the true one in the half gaps on either side."""
    heights_mm = between.points_mm @ toward_base
    rows = []
    for one in across:
        own = [o.points_mm for o in outlines[structure] if o.slice_id == one.slice_id]
        height_mm = float(np.concatenate(own).mean(axis=0) @ toward_base)
        beside = np.abs(heights_mm - height_mm) < 0.5 * gap_mm
        if beside.sum() >= _FEWEST:
            rows.append(
                SliceRow(
                    held_out_mm=float(one.distances_mm.mean()),
                    true_mm=float(between.distances_mm[beside].mean()),
                )
            )
    return rows


if __name__ == "__main__":
    main()
