"""Spheres that beat, measured: what follows from the whole cycle is as the formulas say."""

import math
from dataclasses import replace

import numpy as np
import pytest

from schemas.cycle_report import CycleReport
from schemas.options import Options
from schemas.report import Provenance
from schemas.vocabulary import Axes, Structure
from tests.worker.artifacts.beating_spheres import (
    ENDO,
    EPI,
    EPI_MM,
    PART,
    PERIOD_MS,
    RADIUS_MM,
    RV,
    ball,
    epi_mm,
    frame,
    radius_mm,
    tracked,
)
from worker.artifacts.report import measure
from worker.evaluation.size import volume_ml
from worker.reconstruction.result import FrameFit, LevelSetCurvature, Reconstruction
from worker.surface_mesh import SurfaceMesh
from worker.tracking.tracked_surface import NOT_OBSERVED, TrackedSurface

COUNT = 6
PROVENANCE = Provenance(
    software="neuralmri 0", python="3", libraries={}, seed=0, threads=1, input_sha256="0" * 64
)


def cycle_of(
    *frames: FrameFit,
    surfaces: dict[Structure, TrackedSurface] | None = None,
    references: dict[str, SurfaceMesh] | None = None,
    whole: bool = True,
) -> CycleReport | None:
    options = Options.model_validate({"sequence": {"whole_cycle": whole}})
    return measure(
        Reconstruction("case-01", Axes.LPS, frames),
        options=options,
        warnings=[],
        provenance=PROVENANCE,
        references=references,
        tracked=surfaces,
    ).report.cycle


def known(found: CycleReport | None) -> CycleReport:
    assert found is not None
    return found


def shrunk() -> np.ndarray:
    """Radius of the cavity by frame, over that at end-diastole."""
    return np.array([radius_mm(i, COUNT) for i in range(COUNT)]) / RADIUS_MM


@pytest.fixture(scope="module")
def beat() -> CycleReport:
    labels = [f"F{i}" for i in range(COUNT)]
    carried = {
        ENDO: tracked([ball(radius_mm(i, COUNT)) for i in range(COUNT)], labels),
        # Of its own largest volume, or of another frame: changes are to end-diastole all the same.
        EPI: tracked([ball(epi_mm(i, COUNT)) for i in range(COUNT)], labels, rest=3),
    }
    # Sent in another order than that of time.
    frames = [frame(i, COUNT) for i in (3, 0, 5, 1, 2, 4)]
    return known(cycle_of(*frames, surfaces=carried))


def test_frames_are_in_order_of_time(beat: CycleReport) -> None:
    assert beat.frames == [f"F{i}" for i in range(COUNT)]
    assert beat.times_ms == pytest.approx([i * PERIOD_MS / COUNT for i in range(COUNT)])
    assert beat.period_ms == pytest.approx(PERIOD_MS)
    assert beat.is_whole_cycle
    assert beat.ed_frame == "F0"


def test_a_ventricle_pumps_as_its_radius_says(beat: CycleReport) -> None:
    left, right = beat.chambers[ENDO], beat.chambers[RV]
    assert (left.ed_frame, left.es_frame) == ("F0", "F3")
    # The right one beats a frame later.
    assert (right.ed_frame, right.es_frame) == ("F1", "F4")
    assert left.edv_ml == pytest.approx(volume_ml(ball(RADIUS_MM)))
    assert left.stroke_volume_ml == pytest.approx(left.edv_ml - left.esv_ml)
    emptied = 100.0 * (1.0 - (1.0 - PART) ** 3)
    assert left.ejection_fraction_percent == pytest.approx(emptied)
    assert right.ejection_fraction_percent == pytest.approx(emptied)
    # V' = -3 V0 (1 - a s)2 a s' of s = sin2; six frames of it say so to some percent.
    at = np.linspace(0.0, 0.5, 10_001)
    s, slope = np.sin(np.pi * at) ** 2, np.pi * np.sin(2.0 * np.pi * at)
    rate = (3.0 * left.edv_ml * (1.0 - PART * s) ** 2 * PART * slope).max() / PERIOD_MS * 1000.0
    assert left.peak_ejection_rate_ml_per_s == pytest.approx(rate, rel=0.05)
    assert left.peak_filling_rate_ml_per_s == pytest.approx(rate, rel=0.05)
    bends = np.diff(left.edv_ml * np.append(shrunk()[[-1]], [*shrunk(), shrunk()[0]]) ** 3, 2)
    assert left.jitter_ml == pytest.approx(math.sqrt((bends**2).mean() / 6.0))


def test_surfaces_grow_and_bend_as_their_radius_says(beat: CycleReport) -> None:
    endo = beat.surfaces[ENDO]
    np.testing.assert_allclose(endo.area_change_percent, 100.0 * (shrunk() ** 2 - 1.0), atol=1e-9)
    np.testing.assert_allclose(
        endo.volume_ml, shrunk() ** 3 * volume_ml(ball(RADIUS_MM)), rtol=1e-9
    )
    for name in ("mean", "p5", "p50", "p95"):
        gaussian = getattr(endo.gaussian_curvature_per_mm2, name)
        mean = getattr(endo.mean_curvature_per_mm, name)
        np.testing.assert_allclose(gaussian, (RADIUS_MM * shrunk()) ** -2.0, rtol=1e-9)
        np.testing.assert_allclose(mean, 1.0 / (RADIUS_MM * shrunk()), rtol=1e-9)
    assert endo.above_p90_error_area_percent == [None] * COUNT
    assert endo.above_p75_curvature_area_percent == [None] * COUNT


def test_strain_is_that_of_the_area_and_its_spread_not_observed(beat: CycleReport) -> None:
    assert beat.not_observed == NOT_OBSERVED
    strain = beat.surfaces[ENDO].area_strain_percent
    assert strain is not None
    for name in ("mean", "p5", "p50", "p95"):
        np.testing.assert_allclose(getattr(strain, name), 100.0 * (shrunk() ** 2 - 1.0), atol=1e-9)
    outer = beat.surfaces[EPI]
    assert outer.area_strain_percent is not None
    np.testing.assert_allclose(outer.area_strain_percent.mean, outer.area_change_percent, atol=1e-9)
    segments = beat.surfaces[ENDO].area_strain_by_segment_percent
    assert segments is not None
    # The apex has no inner surface of its own.
    assert set(segments) == set(range(1, 17))
    for series in segments.values():
        np.testing.assert_allclose(series, strain.mean, atol=1e-9)
    assert outer.area_strain_by_segment_percent is not None
    assert set(outer.area_strain_by_segment_percent) == set(range(1, 18))
    assert beat.surfaces[RV].area_strain_percent is None
    assert beat.surfaces[RV].area_strain_by_segment_percent is None


def test_the_left_ventricle_shortens_and_thickens(beat: CycleReport) -> None:
    left = beat.left_ventricle
    shortened = 100.0 * (1.0 - shrunk())
    np.testing.assert_allclose(left.longitudinal_shortening_percent, shortened, atol=1e-9)
    np.testing.assert_allclose(left.circumferential_shortening_percent, shortened, atol=1e-9)
    wall_mm = np.array([epi_mm(i, COUNT) - radius_mm(i, COUNT) for i in range(COUNT)])
    assert set(left.wall_thickness_mm) == set(range(1, 18))
    for number, series in left.wall_thickness_mm.items():
        np.testing.assert_allclose(series, wall_mm, atol=0.25)
        thickened = left.wall_thickening_percent[number]
        assert thickened[0] == 0.0
        np.testing.assert_allclose(thickened, 100.0 * (wall_mm / wall_mm[0] - 1.0), atol=3.0)
    grams = 1.05 * (volume_ml(ball(EPI_MM)) - volume_ml(ball(RADIUS_MM)))
    np.testing.assert_allclose(left.wall_mass_g, [grams] * COUNT, rtol=1e-9)


def test_two_frames_are_no_cycle() -> None:
    assert cycle_of(frame(0, COUNT, (ENDO,)), frame(3, COUNT, (ENDO,))) is None


def test_without_times_there_are_no_rates() -> None:
    frames = [replace(frame(i, COUNT, (ENDO,)), time_ms=None) for i in range(COUNT)]
    found = known(cycle_of(*frames))
    assert (found.times_ms, found.period_ms) == (None, None)
    left = found.chambers[ENDO]
    assert left.peak_ejection_rate_ml_per_s is None
    assert left.peak_filling_rate_ml_per_s is None
    assert left.jitter_ml is not None
    assert left.ejection_fraction_percent > 50.0


def test_part_of_a_cycle_has_no_period() -> None:
    frames = [frame(i, COUNT, (ENDO,)) for i in range(4)]
    found = known(cycle_of(*frames, whole=False))
    assert (found.is_whole_cycle, found.period_ms) == (False, None)
    rate = found.chambers[ENDO].peak_ejection_rate_ml_per_s
    assert rate is not None
    assert rate > 0.0


def test_without_the_left_ventricle_the_right_one_tells_end_diastole() -> None:
    found = known(cycle_of(*(frame(i, COUNT, (RV,)) for i in range(COUNT))))
    assert found.ed_frame == "F1"
    assert set(found.chambers) == {RV}
    assert found.left_ventricle.wall_mass_g == [None] * COUNT
    assert found.left_ventricle.longitudinal_shortening_percent == [None] * COUNT
    assert found.left_ventricle.wall_thickness_mm == {}
    assert found.not_observed is None


def test_what_a_frame_does_not_have_is_null_there() -> None:
    """F2 has the right ventricle alone; F4's cavity is open."""
    lacking = frame(2, COUNT, (RV,))
    cut = frame(4, COUNT)
    whole = cut.surfaces[ENDO]
    opened = SurfaceMesh(whole.vertices_mm, whole.faces[:-20])
    cut = replace(cut, surfaces={**cut.surfaces, ENDO: opened})
    frames = [frame(i, COUNT) for i in (0, 1, 3, 5)]
    found = known(cycle_of(*frames, lacking, cut))
    endo = found.surfaces[ENDO]
    assert [one is None for one in endo.volume_ml] == [i in (2, 4) for i in range(COUNT)]
    assert [one is None for one in endo.area_cm2] == [i == 2 for i in range(COUNT)]
    assert [one is None for one in endo.mean_curvature_per_mm.p50] == [i == 2 for i in range(COUNT)]
    assert found.chambers[ENDO].es_frame == "F3"
    assert found.chambers[ENDO].peak_ejection_rate_ml_per_s is not None
    thickness = found.left_ventricle.wall_thickness_mm[8]
    assert [one is None for one in thickness] == [i == 2 for i in range(COUNT)]


def test_curvature_that_is_no_number_at_a_vertex_does_not_count() -> None:
    frames = [frame(i, COUNT, (ENDO,)) for i in range(3)]
    bent = frames[1].curvature[ENDO]
    holed = np.where(np.arange(len(bent.mean_per_mm)) < 5, np.nan, bent.mean_per_mm)
    none = np.full_like(holed, np.inf)
    frames[1] = replace(frames[1], curvature={ENDO: LevelSetCurvature(none, holed)})
    found = known(cycle_of(*frames)).surfaces[ENDO]
    assert found.mean_curvature_per_mm.mean[1] == pytest.approx(1.0 / radius_mm(1, COUNT))
    assert found.gaussian_curvature_per_mm2.p95[0] is not None
    assert found.gaussian_curvature_per_mm2.p95[1] is None


def test_open_everywhere_the_largest_area_is_end_diastole() -> None:
    def opened(fit: FrameFit) -> FrameFit:
        mesh = fit.surfaces[ENDO]
        return replace(fit, surfaces={ENDO: SurfaceMesh(mesh.vertices_mm, mesh.faces[:-20])})

    found = known(cycle_of(*(opened(frame(i, COUNT, (ENDO,))) for i in (2, 0, 1))))
    assert found.ed_frame == "F0"
    assert found.chambers == {}
    assert found.surfaces[ENDO].area_change_percent[0] == 0.0


def test_a_surface_not_tracked_to_end_diastole_has_no_strain() -> None:
    labels = ["F1", "F2", "F3"]
    carried = tracked([ball(radius_mm(i, COUNT)) for i in (1, 2, 3)], labels)
    frames = [frame(i, COUNT, (ENDO,)) for i in range(4)]
    found = known(cycle_of(*frames, surfaces={ENDO: carried}))
    assert found.surfaces[ENDO].area_strain_percent is None
    known_at = tracked([ball(radius_mm(i, COUNT)) for i in (0, 1, 3)], ["F0", "F1", "F3"])
    strain = known(cycle_of(*frames, surfaces={ENDO: known_at})).surfaces[ENDO].area_strain_percent
    assert strain is not None
    assert [one is None for one in strain.mean] == [False, False, True, False]


def test_regions_of_error_are_told_where_a_reference_is() -> None:
    """A reference further to one side: its error, and so its worst tenth, lies there."""
    frames = [frame(i, COUNT, (ENDO,)) for i in range(3)]
    references = {"F1_lv_endo": ball(radius_mm(1, COUNT), 1.0)}
    found = known(cycle_of(*frames, references=references)).surfaces[ENDO]
    shares = found.above_p90_error_area_percent
    assert [one is None for one in shares] == [True, False, True]
    assert shares[1] == pytest.approx(10.0, abs=2.0)
    assert [one is None for one in found.above_p75_curvature_area_percent] == [True, False, True]


def test_a_larger_heart_changes_by_the_same_parts(beat: CycleReport) -> None:
    """All lengths doubled: volumes by 8, changes not at all."""

    def doubled(fit: FrameFit) -> FrameFit:
        meshes = {s: SurfaceMesh(2.0 * m.vertices_mm, m.faces) for s, m in fit.surfaces.items()}
        return replace(fit, surfaces=meshes)

    found = known(cycle_of(*(doubled(frame(i, COUNT)) for i in range(COUNT))))
    left, before = found.chambers[ENDO], beat.chambers[ENDO]
    assert left.edv_ml == pytest.approx(8.0 * before.edv_ml)
    assert left.ejection_fraction_percent == pytest.approx(before.ejection_fraction_percent)
    assert before.peak_ejection_rate_ml_per_s is not None
    assert left.peak_ejection_rate_ml_per_s == pytest.approx(
        8.0 * before.peak_ejection_rate_ml_per_s
    )
    np.testing.assert_allclose(
        found.surfaces[ENDO].area_change_percent, beat.surfaces[ENDO].area_change_percent, atol=1e-9
    )
    np.testing.assert_allclose(
        found.left_ventricle.circumferential_shortening_percent,
        beat.left_ventricle.circumferential_shortening_percent,
        atol=1e-9,
    )
