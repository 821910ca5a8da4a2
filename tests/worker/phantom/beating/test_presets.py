import numpy as np
import pytest

from schemas.vocabulary import Structure
from worker.evaluation.size import volume_ml
from worker.phantom.beating import PRESETS, BeatPreset


def test_every_name_has_a_heart():
    assert set(PRESETS) == set(BeatPreset)


def test_both_ventricles_eject_the_same(beating):
    times_ms = np.array([0.0, beating.beat.cycle.end_systole_ms])
    left_ml = -np.diff(beating.lv_volumes_ml(times_ms)[Structure.LV_ENDO])[0]
    right = beating.surfaces(times_ms, 1.5)[Structure.RV_ENDO]
    right_ml = volume_ml(right.frame(0)) - volume_ml(right.frame(1))
    assert right_ml == pytest.approx(left_ml, abs=1.0)


def test_the_dilated_heart_is_large_and_weak():
    case = PRESETS[BeatPreset.DILATED]
    assert case.beat.ejection_fraction_percent == 25.0
    assert case.shape.lv_radius_mm > 30.0
