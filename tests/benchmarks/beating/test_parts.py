"""Every part in small, by the real engine."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.beating.killed_run import beating_request, compared, killed_run
from benchmarks.beating.phantom_beats import Tracked, measured_beat
from benchmarks.beating.real_cycle import run_row
from benchmarks.beating.real_run import real_run
from benchmarks.beating.sliced_cycle import sliced
from benchmarks.stack import IMPATIENT
from cli.same_results import Verdict
from schemas.messages import ContourRequest
from schemas.options import Options
from schemas.vocabulary import Structure
from worker.phantom.beating import BeatingHeart, BeatPreset, sliced_beat

QUICK = Options.model_validate(
    {"levels": 2, "iterations_per_level": 60, "mesh": {"grid_mm": 4.0}, "formats": ["stl"]}
)


@pytest.mark.slow
def test_a_phantom_tracked_over_its_true_surfaces_keeps_to_them() -> None:
    rows = measured_beat(BeatPreset.HEALTHY, Tracked.TRUE, 5, QUICK)
    assert {row.surface for row in rows} == {
        Structure.LV_ENDO,
        Structure.LV_EPI,
        Structure.RV_ENDO,
    }
    for row in rows:
        assert max(row.normal_mm) < 0.6
        assert row.normal_mm[0] + row.tangential_mm[0] < 1e-6
        assert (row.mesh.turned_over, row.mesh.folded) == (0, 0)
        np.testing.assert_allclose(row.found_ml, row.true_ml, rtol=0.02)
        np.testing.assert_allclose(row.strain_percent, row.true_strain_percent, atol=4.0)


@pytest.mark.slow
def test_known_surfaces_are_sliced_and_found_again() -> None:
    truth = list(sliced_beat(BeatingHeart(), 3, edge_mm=2.0).frames().values())
    found = sliced(truth, QUICK)
    assert [one.surface for one in found.surfaces] == list(truth[0])
    for one in found.surfaces:
        assert len(one.warm_mm) == len(one.cold_mm) == len(one.tracked_mm) == 3
        assert max(*one.warm_mm, *one.cold_mm, *one.tracked_mm) < 3.0
        assert one.true_ml[0] > one.true_ml[1]
    assert found.warm_cpu_s < found.cold_cpu_s


@pytest.mark.slow
def test_a_run_in_a_process_of_its_own_says_what_it_cost() -> None:
    study = sliced_beat(BeatingHeart(), 3, edge_mm=3.0).sliced.study
    found = real_run(ContourRequest(study=study, options=QUICK), 1)
    row = run_row(1, found)
    assert row.from_nothing == ["F00"]
    assert set(row.fit_cpu_s) == {"F00", "F01", "F02"}
    assert 0.0 < row.wall_s < row.process_s
    assert sum(row.fit_cpu_s.values()) < row.cpu_s
    assert row.peak_mib > 100.0


@pytest.mark.slow
@pytest.mark.integration
def test_a_killed_job_fits_no_frame_again() -> None:
    found = killed_run(6, IMPATIENT)
    assert found.finished >= 3
    assert found.taken_up == found.finished
    assert (found.fitted_again, found.attempts, found.not_the_same) == (0, 2, [])


def test_a_request_of_a_cycle_narrows_in_its_planes() -> None:
    study = beating_request("cycle", 4)["study"]
    widths = [
        np.ptp(np.array(frame["slices"][0]["contours"][0]["points"]), axis=0)
        for frame in study["frames"]
    ]
    np.testing.assert_allclose([w[0] / widths[0][0] for w in widths], [1.0, 0.9, 0.8, 0.9])
    assert all(width[2] == 0.0 for width in widths)


def test_artifacts_are_compared_by_name(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    for folder in (one, other):
        folder.mkdir()
        (folder / "manifest.json").write_text(folder.name)
        (folder / "same.txt").write_text("same")
    (one / "gone.txt").touch()
    assert compared(one, other) == {"same.txt": Verdict.SAME, "gone.txt": Verdict.MISSING}
