"""Every chosen method on one case: records, one a surface."""

import sys
from collections.abc import Iterator, Sequence

from benchmarks.cases import Case, factors
from benchmarks.errors import errors, residual_mm
from benchmarks.long_axis import apex_to_base
from benchmarks.measure import Failed, Measured, measured
from benchmarks.methods import Method
from benchmarks.results import CaseFacts, Record
from schemas.vocabulary import Structure, View
from worker.evaluation.size import volume_ml
from worker.evaluation.thirds import Thirds, thirds
from worker.reconstruction.stacking import build_stack


def facts(case: Case) -> CaseFacts:
    """What to say about a case."""
    slices = case.study.frames[0].slices
    shown = _displaceable(case)
    return CaseFacts(
        name=case.name,
        short_axis_slices=sum(s.view is View.SAX for s in slices),
        long_axis_slices=sum(s.view is not View.SAX for s in slices),
        factors=factors(case.plan) if case.plan else {},
        displaced_rms_mm=residual_mm({}, case.true_shifts_mm, shown),
        truth_ml={s: volume_ml(mesh) for s, mesh in case.truth.items()},
    )


def records(case: Case, methods: Sequence[Method]) -> Iterator[Record]:
    """One record a method and surface, methods one after the other; progress goes to stderr."""
    stack = build_stack(case.study, case.study.frames[0])
    axis = apex_to_base(stack, case.truth)
    parts = {s: thirds(mesh, axis) for s, mesh in case.truth.items()}
    for method in methods:
        outcome = measured(method.entry, case.study)
        took = outcome.reason if isinstance(outcome, Failed) else f"{outcome.cost.wall_s:.1f} s"
        print(f"{case.name} | {method.name} | {took}", file=sys.stderr, flush=True)
        for structure in case.truth:
            yield _record(case, method, outcome, structure, parts[structure])


def _record(
    case: Case, method: Method, outcome: Measured | Failed, structure: Structure, parts: Thirds
) -> Record:
    record = Record(case=case.name, method=method.name, surface=structure)
    if isinstance(outcome, Failed):
        return record.model_copy(update={"failure": outcome.reason})
    found, cost = outcome.found, outcome.cost
    known: dict[str, object] = {
        "wall_s": cost.wall_s,
        "cpu_s": cost.cpu_s,
        "peak_mib": cost.peak_mib,
        "libraries_mib": cost.libraries_mib,
    }
    if found.shifts_mm:
        known["shift_rms_mm"] = residual_mm(
            found.shifts_mm, case.true_shifts_mm, _displaceable(case)
        )
    mesh = found.surfaces.get(structure)
    if mesh is None or not len(mesh.faces):
        known["failure"] = found.failures.get(structure, "no surface")
        return record.model_copy(update=known)
    by_region = errors(mesh, case.truth[structure], parts)
    named = {region or "whole": value for region, value in by_region.items()}
    return record.model_copy(update={**known, **named})


def _displaceable(case: Case) -> frozenset[str]:
    """Short-axis slices with outlines: a breath-hold displaces the others unseen."""
    slices = case.study.frames[0].slices
    return frozenset(s.id for s in slices if s.view is View.SAX and s.contours)
