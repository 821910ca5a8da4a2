"""A run in few numbers: ratios case by case, and their geometric means."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from benchmarks.methods import METHODS, Method
from benchmarks.results import CaseFacts, Record, Results
from schemas.vocabulary import Structure


@dataclass(frozen=True)
class Ratio:
    """One method's errors over another's on one surface of one case; below one it is closer."""

    case: str
    surface: Structure
    mean: float
    p95: float
    maximum: float


@dataclass(frozen=True)
class Group:
    """Cases that the summary tells apart, because they ask different things of a method."""

    title: str
    has: Callable[[CaseFacts], bool]


GROUPS = (
    Group("phantom in place", lambda case: bool(case.factors) and not case.displaced_rms_mm),
    Group("anatomy in place", lambda case: not case.factors and not case.displaced_rms_mm),
    Group("displaced", lambda case: case.displaced_rms_mm > 0.0),
)
"""In place: no breath-hold displaced a slice. Anatomy: a case from a folder, not a phantom."""


def groups_of(results: Results) -> list[tuple[str, set[str]]]:
    """Title and names of the cases of every group that a run has."""
    named = [(g.title, {case.name for case in results.cases if g.has(case)}) for g in GROUPS]
    return [(title, names) for title, names in named if names]


def taking_part(results: Results) -> list[Method]:
    """The methods of a run in the order of the tables."""
    names = {record.method for record in results.records}
    return [method for method in METHODS if method.name in names]


def of_method(results: Results, method: str) -> list[Record]:
    """A method's records, failures included."""
    return [r for r in results.records if r.method == method]


def geometric_mean(values: Iterable[float]) -> float:
    """exp of the mean of logs, NaN of nothing: halving and doubling cancel."""
    logs = [math.log(value) for value in values]
    return math.exp(math.fsum(logs) / len(logs)) if logs else math.nan


def ratios(results: Results, own: str, other: str) -> list[Ratio]:
    """Where both methods have a surface, `own` over `other`, in the order of the run."""
    others = {(r.case, r.surface): r.whole for r in of_method(results, other)}
    found = []
    for record in of_method(results, own):
        rival, whole = others.get((record.case, record.surface)), record.whole
        if rival and whole:
            mean, p95 = whole.mean_mm / rival.mean_mm, whole.p95_mm / rival.p95_mm
            maximum = whole.max_mm / rival.max_mm
            found.append(Ratio(record.case, record.surface, mean, p95, maximum))
    return found
