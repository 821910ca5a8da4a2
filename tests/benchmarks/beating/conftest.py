"""A small run, written down: three frames of each part."""

import pytest

from benchmarks.beating.results import (
    BeatingResults,
    KilledRun,
    PhantomBeats,
    PhantomSurface,
    RealCycle,
    Residuals,
    RunRow,
    SlicedCycle,
    SlicedSurface,
    TrackedRow,
)
from benchmarks.results import Environment
from schemas.vocabulary import Structure

WHERE = Environment(
    cpu="A processor",
    cores=2,
    threads=1,
    memory_gib=16.0,
    load=0.1,
    system="Linux x86_64",
    python="3.11.7",
    libraries={"torch": "2.13.0"},
)

MESH = TrackedRow(
    vertices=100,
    to_own_mm=[0.0, 0.1, 0.2],
    from_own_mm=[0.0, 0.2, 0.4],
    turned_over=0,
    against_surface=1,
    folded=0,
    self_intersections=2,
    least_angle_deg=21.0,
    drift_mean_mm=0.25,
    drift_max_mm=1.5,
)


def run(processes: int, wall_s: float) -> RunRow:
    return RunRow(
        processes=processes,
        process_s=wall_s + 5.0,
        wall_s=wall_s,
        cpu_s=2.0 * wall_s,
        peak_mib=700.0,
        stages_s={"fitting": 0.5 * wall_s, "measuring": 0.25 * wall_s, "total": 0.75 * wall_s},
        fit_cpu_s={"t0": 9.0, "t1": 2.0, "t2": 3.0},
        from_nothing=["t0"],
        failed=[],
    )


@pytest.fixture
def results() -> BeatingResults:
    real = RealCycle(
        environment=WHERE,
        frames=["t0", "t1", "t2"],
        times_ms=None,
        runs=[run(1, 80.0), run(2, 60.0)],
        residuals={Structure.LV_ENDO: Residuals(mean_mm=[0.5, 0.7, None], p95_mm=[1.0, 2.0, None])},
        warm_ml={Structure.LV_ENDO: [100.0, 40.0, None]},
        cold_ml={Structure.LV_ENDO: [101.0, 42.0, 70.0]},
        model_ml={Structure.LV_ENDO: [99.0, 39.0, 71.0]},
        cold_cpu_s=10.0,
    )
    sliced = SlicedCycle(
        environment=WHERE,
        frames=3,
        surfaces=[
            SlicedSurface(
                surface=Structure.LV_ENDO,
                warm_mm=[0.1, 0.2, 0.3],
                cold_mm=[0.2, 0.4, 0.6],
                true_ml=[100.0, 50.0, 80.0],
                warm_ml=[101.0, 51.0, 81.0],
                cold_ml=[100.0, 40.0, 80.0],
                tracked=MESH,
                tracked_mm=[0.2, 0.3, 0.4],
            )
        ],
        warm_cpu_s=9.0,
        cold_cpu_s=30.0,
    )
    beats = PhantomBeats(
        environment=WHERE,
        frames=3,
        surfaces=[
            PhantomSurface(
                preset="healthy",
                tracked="true surfaces",
                surface=Structure.LV_ENDO,
                normal_mm=[0.0, 0.1, 0.05],
                tangential_mm=[0.0, 2.0, 1.0],
                p95_mm=[0.0, 4.0, 2.0],
                true_strain_percent=[0.0, -40.0, -20.0],
                strain_percent=[0.0, -39.0, -21.0],
                strain_error_percent=[0.0, 5.0, 3.0],
                true_ml=[100.0, 40.0, 80.0],
                found_ml=[100.0, 42.0, 80.0],
                mesh=MESH,
            )
        ],
    )
    broken = KilledRun(
        environment=WHERE,
        frames=25,
        finished=12,
        taken_up=12,
        fitted_again=0,
        attempts=2,
        noticed_s=40.0,
        next_frame_s=45.0,
        broken_s=70.0,
        unbroken_s=20.0,
        artifacts={"same": 75},
        not_the_same=[],
    )
    return BeatingResults(patient1=real, sliced=sliced, phantom=beats, killed=broken)
