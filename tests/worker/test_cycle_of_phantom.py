"""The beating phantom, sliced and reconstructed: what the report says of its cycle is the truth."""

from pathlib import Path

import numpy as np
import pytest

from schemas.options import Options
from schemas.vocabulary import Structure
from worker.evaluation.chamber import mid_perimeter_mm
from worker.evaluation.size import area_cm2
from worker.phantom.beating import BeatingHeart, sliced_beat
from worker.subject import run

FRAMES = 5
"""At 400 ms of a second the third stands at end-systole, where volumes rest for 70 ms."""

QUICK = {
    "preset": "fast",
    "levels": 3,
    "iterations_per_level": 120,
    "mesh": {"grid_mm": 2.5},
    "formats": ["ply"],
    "tracked_meshes": True,
}

ENDO, EPI = Structure.LV_ENDO, Structure.LV_EPI


@pytest.mark.slow
def test_a_reconstructed_beat_pumps_shortens_and_thickens_as_the_true_one(tmp_path: Path) -> None:
    heart = BeatingHeart()
    beat = sliced_beat(heart, FRAMES, edge_mm=2.0)
    report = run(
        beat.sliced.study,
        Options.model_validate(QUICK),
        tmp_path,
        threads=1,
        input_sha256="a" * 64,
    ).report
    cycle = report.cycle
    assert cycle is not None
    assert (cycle.frames, cycle.ed_frame) == (list(beat.labels), "F00")
    assert cycle.period_ms == pytest.approx(heart.beat.cycle.duration_ms)
    left, surface = cycle.chambers[ENDO], cycle.surfaces[ENDO]
    true_ml = heart.lv_volumes_ml(beat.times_ms)[ENDO]
    np.testing.assert_allclose(surface.volume_ml, true_ml, atol=0.03 * true_ml[0])
    assert left.es_frame == "F02"
    assert left.ejection_fraction_percent == pytest.approx(60.0, abs=2.5)
    assert report.function is not None
    assert (report.function.ed_frame, report.function.es_frame) == ("F00", "F02")
    true_cm2 = np.array([area_cm2(beat.surfaces[ENDO].frame(i)) for i in range(FRAMES)])
    true_change = 100.0 * (true_cm2 / true_cm2[0] - 1.0)
    np.testing.assert_allclose(surface.area_change_percent, true_change, atol=3.0)
    strain = surface.area_strain_percent
    assert strain is not None
    np.testing.assert_allclose(strain.mean, true_change, atol=4.0)
    shortened = [100.0 * (1.0 - one.stretch) for one in heart.instants(beat.times_ms)]
    np.testing.assert_allclose(
        cycle.left_ventricle.longitudinal_shortening_percent, shortened, atol=3.0
    )
    axis = heart.pose.rotation[:, 2]
    true_mm = [mid_perimeter_mm(beat.surfaces[ENDO].frame(i), axis) for i in range(FRAMES)]
    np.testing.assert_allclose(
        cycle.left_ventricle.circumferential_shortening_percent,
        100.0 * (1.0 - np.array(true_mm) / true_mm[0]),
        atol=3.0,
    )
    grams = cycle.left_ventricle.wall_mass_g
    np.testing.assert_allclose(grams, [grams[0]] * FRAMES, rtol=0.06)
    thickened = cycle.left_ventricle.wall_thickening_percent
    assert all(thickened[segment][2] > 20.0 for segment in range(1, 13))
