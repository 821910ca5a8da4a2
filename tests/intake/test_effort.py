import pytest

from intake.effort import MESHING_SHARE, REFIT_COST, effort, warm_cost
from schemas.options import Holdout, Options
from schemas.study import ContourStudy
from schemas.vocabulary import Structure


def study(frames: int, slices: int) -> ContourStudy:
    def one(height: float) -> dict[str, object]:
        points = [[20.0, 0.0, height], [0.0, 20.0, height], [-20.0, -20.0, height]]
        return {
            "id": f"sax-{height:.0f}",
            "view": "sax",
            "contours": [{"structure": "lv_endo", "points": points}],
        }

    return ContourStudy.model_validate(
        {
            "subject_id": "a",
            "units": "mm",
            "axes": "LPS",
            "frames": [
                {"label": f"t{k}", "slices": [one(8.0 * i) for i in range(slices)]}
                for k in range(frames)
            ],
        }
    )


@pytest.mark.parametrize(
    ("options", "each"),
    [
        (Options(), 1.0),
        (Options(ensemble=3), 4.0),
        (Options(holdout=Holdout.LEAVE_ONE_SLICE_OUT), 1.0 + 9 * REFIT_COST),
        (Options(holdout=Holdout.LEAVE_ONE_SLICE_OUT, ensemble=1), 2.0 + 9 * REFIT_COST),
    ],
)
def test_effort_is_counted_in_fits(options: Options, each: float) -> None:
    assert effort(study(1, 9), options) == pytest.approx(each)
    assert effort(study(2, 9), options) == pytest.approx(2 * each)


def test_frames_that_go_on_from_a_neighbour_cost_less() -> None:
    options = Options()
    assert effort(study(5, 9), options) == pytest.approx(1.0 + 4 * warm_cost(options))
    assert MESHING_SHARE < warm_cost(options) < 0.5
    cold = options.sequence.model_copy(update={"warm_start": False})
    assert effort(study(5, 9), options.model_copy(update={"sequence": cold})) == pytest.approx(5.0)


def test_a_slice_that_shows_none_of_the_surfaces_is_not_left_out() -> None:
    mixed = study(1, 9).model_dump(mode="json")
    mixed["frames"][0]["slices"][0]["contours"][0]["structure"] = "rv_endo"
    asked = Options(surfaces=[Structure.LV_ENDO], holdout=Holdout.LEAVE_ONE_SLICE_OUT)
    assert effort(ContourStudy.model_validate(mixed), asked) == pytest.approx(1.0 + 8 * REFIT_COST)
