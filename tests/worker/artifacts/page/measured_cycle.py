"""The phantom over a cycle, as if it had been reconstructed and one surface tracked."""

from dataclasses import replace

import numpy as np

from schemas.cycle_report import (
    ChamberCycleReport,
    CycleReport,
    LeftVentricleCycleReport,
    SpreadSeries,
    SurfaceCycleReport,
)
from schemas.vocabulary import Structure
from tests.worker.artifacts.page.measured_phantom import measured_phantom
from worker.artifacts.measured import Measured
from worker.evaluation.distance import DirectedDistance
from worker.surface_mesh import SurfaceMesh
from worker.tracking.tracked_surface import TrackedFrame, TrackedSurface

STEP_MS = 40.0


def labels_of(count: int) -> list[str]:
    return [f"F{n:02d}" for n in range(count)]


def measured_cycle(
    count: int = 4, *, times: bool = True, cycle: bool = True, edge_mm: float = 5.0
) -> Measured:
    """F00 is full and the last frame empty; lv_endo is tracked, the others are not."""
    labels = labels_of(count)
    measured = measured_phantom(labels, edge_mm=edge_mm, reference=False)
    frames = [
        frame.model_copy(update={"time_ms": n * STEP_MS if times else None})
        for n, frame in enumerate(measured.report.frames)
    ]
    report = measured.report.model_copy(
        update={"frames": frames, "cycle": cycle_report(count, times=times) if cycle else None}
    )
    first = measured.frames[0].surfaces[Structure.LV_ENDO].mesh
    return replace(measured, report=report, tracked={Structure.LV_ENDO: tracked(first, labels)})


def tracked(mesh: SurfaceMesh, labels: list[str]) -> TrackedSurface:
    """A mesh that shrinks by 4 % a frame."""
    near = DirectedDistance(0.1, 0.1, 0.1, 0.2, 0.2, 0.3, 100)
    frame = TrackedFrame("", near, near, 0, 0, 0, 0, 31.0, 0.0, 0.9, 1.1, 0.5, 1.0)
    return TrackedSurface(
        vertices_mm=np.stack([mesh.vertices_mm * 0.96**n for n in range(len(labels))]),
        faces=mesh.faces,
        rest=0,
        frames=tuple(replace(frame, label=label) for label in labels),
        drift_mean_mm=None,
        drift_max_mm=None,
    )


def spread(count: int, size: float) -> SpreadSeries:
    middle = [size * n for n in range(count)]
    return SpreadSeries(
        mean=middle,
        p5=[x - abs(size) for x in middle],
        p50=middle,
        p95=[x + abs(size) for x in middle],
    )


def cycle_report(count: int, *, times: bool = True) -> CycleReport:
    """With a number of its own in every place; the last frame has no error regions."""
    falling = [100.0 - 20.0 * n for n in range(count)]
    chamber = ChamberCycleReport(
        ed_frame="F00",
        es_frame=labels_of(count)[-1],
        edv_ml=101.25,
        esv_ml=41.75,
        stroke_volume_ml=59.5,
        ejection_fraction_percent=58.7,
        peak_ejection_rate_ml_per_s=456.7 if times else None,
        peak_filling_rate_ml_per_s=345.6 if times else None,
        jitter_ml=0.43,
    )
    return CycleReport(
        frames=labels_of(count),
        times_ms=[n * STEP_MS for n in range(count)] if times else None,
        is_whole_cycle=True,
        ed_frame="F00",
        chambers={Structure.LV_ENDO: chamber},
        surfaces={
            structure: SurfaceCycleReport(
                volume_ml=[x + 10.0 * place for x in falling],
                area_cm2=falling,
                area_change_percent=[x - 100.0 for x in falling],
                gaussian_curvature_per_mm2=spread(count, 1e-3),
                mean_curvature_per_mm=spread(count, 1e-2),
                area_strain_percent=spread(count, -5.0) if place == 0 else None,
                area_strain_by_segment_percent={n: falling for n in range(1, 18)}
                if place == 0
                else None,
                above_p90_error_area_percent=[9.0] * (count - 1) + [None],
                above_p75_curvature_area_percent=[24.0] * (count - 1) + [None],
            )
            for place, structure in enumerate(
                (Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO)
            )
        },
        left_ventricle=LeftVentricleCycleReport(
            longitudinal_shortening_percent=[3.0 * n for n in range(count)],
            circumferential_shortening_percent=[5.0 * n for n in range(count)],
            wall_mass_g=[120.0 + n for n in range(count)],
            wall_thickness_mm={n: [8.0 + n / 8 + k for k in range(count)] for n in range(1, 18)},
            wall_thickening_percent={
                n: [(10.0 + n) * k for k in range(count)] for n in range(1, 18)
            },
        ),
    )
