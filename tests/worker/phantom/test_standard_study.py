from schemas.vocabulary import Structure
from worker.phantom import SlicingPlan, standard_study
from worker.phantom.standard_study import ONE_BEAT


def test_it_is_one_diastolic_frame_of_three_structures():
    study = standard_study(edge_mm=2.0)
    (frame,) = study.frames
    assert frame.label == "ED"
    assert {c.structure for s in frame.slices for c in s.contours} == {
        Structure.LV_ENDO,
        Structure.LV_EPI,
        Structure.RV_ENDO,
    }


def test_it_may_be_a_beat_and_sparser():
    study = standard_study(ONE_BEAT, plan=SlicingPlan(spacing_mm=12.0), edge_mm=3.0)
    assert [f.label for f in study.frames] == ["ED", "ES"]
    assert study == standard_study(ONE_BEAT, plan=SlicingPlan(spacing_mm=12.0), edge_mm=3.0)
