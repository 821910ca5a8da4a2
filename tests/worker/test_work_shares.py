from schemas.options import Options
from schemas.study import ContourStudy
from worker.phantom.standard_study import standard_study
from worker.work_shares import work_shares


def beating(frames: int) -> ContourStudy:
    study = standard_study(edge_mm=5.0)
    again = [
        study.frames[0].model_copy(update={"label": f"t{index:03d}"}) for index in range(frames)
    ]
    return study.model_copy(update={"frames": again})


def test_parts_follow_each_other_and_leave_something_to_writing() -> None:
    for options in (Options(), Options(tracked_meshes=True)):
        shares = work_shares(beating(4), options)
        assert 0.0 < shares.reconstructed <= shares.tracked < shares.measured < 1.0
        assert (shares.reconstructed < shares.tracked) == options.tracked_meshes


def test_the_longer_the_fits_take_the_less_of_the_whole_is_measuring() -> None:
    one, many = work_shares(beating(1), Options()), work_shares(beating(20), Options())
    assert many.reconstructed < one.reconstructed
    with_others = work_shares(beating(1), Options(ensemble=4))
    assert with_others.reconstructed > one.reconstructed
