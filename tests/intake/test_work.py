"""Work grows with what is asked for, and is 1 for the standard fit of a frame."""

import pytest

from intake.work import contour_work, label_work, rescaled
from schemas.options import Holdout, Options, Preset
from schemas.study import ContourStudy
from tests.studies.ellipsoid import good_request


def test_a_standard_fit_of_a_frame_is_one() -> None:
    study = ContourStudy.model_validate(good_request()["study"])
    assert contour_work(study, Options()) == pytest.approx(1.0)
    assert label_work(3, Options()) == pytest.approx(3.0)


def test_presets_are_told_apart() -> None:
    fast, standard, paper = (label_work(1, Options(preset=p)) for p in Preset)
    assert fast < 0.5 * standard < standard < paper


@pytest.mark.parametrize(
    "more",
    [
        {"levels": 8},
        {"iterations_per_level": 1000},
        {"ensemble": 1},
        {"holdout": Holdout.LEAVE_ONE_SLICE_OUT},
        {"network": {"width": 128}},
        {"optimizer": {"samples_per_step": 4096}},
        {"mesh": {"grid_mm": 0.5}},
    ],
)
def test_more_is_more(more: dict[str, object]) -> None:
    study = ContourStudy.model_validate(good_request()["study"])
    assert contour_work(study, Options.model_validate(more)) > 1.01


def test_other_options_rescale_what_is_known() -> None:
    fast = Options(preset=Preset.FAST)
    assert rescaled(5.0, Options(), fast) == pytest.approx(label_work(5, fast))
    assert rescaled(5.0, fast, fast) == pytest.approx(5.0)
