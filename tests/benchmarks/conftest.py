"""A small run, written down: two cases, five methods, one surface, one failure."""

import pytest

from benchmarks.cases import STANDARD, factors
from benchmarks.results import CaseFacts, Environment, Errors, Pair, Record, Results, Speed
from schemas.vocabulary import Structure

PHANTOM, SHIFTED = "phantom 8 mm 3 LAX", "heart-shifted"


def errors(mean_mm: float) -> Errors:
    return Errors(
        mean_mm=mean_mm,
        rms_mm=1.5 * mean_mm,
        p95_mm=3.0 * mean_mm,
        max_mm=10.0 * mean_mm,
        volume_error_percent=-mean_mm,
    )


def record(case: str, method: str, mean_mm: float, shift_rms_mm: float | None = None) -> Record:
    return Record(
        case=case,
        method=method,
        surface=Structure.LV_ENDO,
        whole=errors(mean_mm),
        apex=errors(2.0 * mean_mm),
        mid=errors(0.5 * mean_mm),
        base=errors(mean_mm),
        wall_s=8.0,
        cpu_s=7.5,
        peak_mib=500.0,
        libraries_mib=300.0,
        shift_rms_mm=shift_rms_mm,
    )


def facts(name: str, plan_factors: dict[str, float], displaced_rms_mm: float) -> CaseFacts:
    return CaseFacts(
        name=name,
        short_axis_slices=10,
        long_axis_slices=3,
        factors=plan_factors,
        displaced_rms_mm=displaced_rms_mm,
        truth_ml={Structure.LV_ENDO: 118.0},
    )


@pytest.fixture
def results() -> Results:
    return Results(
        environment=Environment(
            cpu="A processor",
            cores=2,
            threads=1,
            memory_gib=16.0,
            load=0.1,
            system="Linux x86_64",
            python="3.11.7",
            libraries={"torch": "2.13.0"},
        ),
        cases=[facts(PHANTOM, factors(STANDARD), 0.0), facts(SHIFTED, {}, 4.0)],
        records=[
            record(PHANTOM, "field-standard", 0.06, 0.03),
            record(PHANTOM, "field-unaligned", 0.05),
            record(PHANTOM, "hermite-rbf", 0.12),
            record(PHANTOM, "hermite-rbf-refined", 0.08),
            Record(case=PHANTOM, method="lofting", surface=Structure.LV_ENDO, failure="no surface"),
            record(SHIFTED, "field-standard", 0.2, 0.4),
            record(SHIFTED, "field-unaligned", 1.0),
            record(SHIFTED, "hermite-rbf", 1.6),
            record(SHIFTED, "hermite-rbf-refined", 0.8),
            record(SHIFTED, "lofting", 1.5),
        ],
        speed=Speed(
            gflop=169.0,
            products=34000,
            pairs=[
                Pair(fit_s=8.0, products_s=2.0),
                Pair(fit_s=9.0, products_s=3.0),
                Pair(fit_s=10.0, products_s=2.0),
            ],
            workers=2,
            subjects_per_minute_alone=[6.0, 5.0, 7.0],
            subjects_per_minute_together=[11.0, 9.0, 12.0],
        ),
    )
