"""A cycle of which frames are missing: what is told, what is not, and why."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from schemas.frame_report import StudyFrame
from schemas.options import Options
from schemas.vocabulary import Axes
from tests.worker.artifacts.beating_spheres import ENDO, EPI, PERIOD_MS, ball, frame, radius_mm
from tests.worker.artifacts.beating_spheres import tracked as tracked_through
from tests.worker.artifacts.mesh_files.gltf_player import check, gltf
from tests.worker.artifacts.test_cycle_report import PROVENANCE
from worker.artifacts.measured import Measured
from worker.artifacts.playback import write_playback
from worker.artifacts.report import measure
from worker.reconstruction.result import FailedFrame, FrameFit, Reconstruction

COUNT = 8
STEP_MS = PERIOD_MS / COUNT
OPTIONS = Options.model_validate({"formats": ["vtp", "glb"]})
ALL = tuple(range(COUNT))


def part_of(
    there: tuple[int, ...],
    *,
    stopped_early: bool = False,
    times: bool = True,
    names: dict[int, str] | None = None,
) -> Measured:
    """The frames `there` of eight, lv_endo tracked and lv_epi not; the others failed."""
    labels = [(names or {}).get(n, f"F{n}") for n in ALL]
    study = tuple(
        StudyFrame(label=label, time_ms=n * STEP_MS if times else None)
        for n, label in enumerate(labels)
    )
    fits: list[FrameFit] = [
        replace(frame(n, COUNT, (ENDO, EPI)), label=labels[n], time_ms=study[n].time_ms)
        for n in there
    ]
    found = Reconstruction(
        "case-01",
        Axes.LPS,
        tuple(fits),
        tuple(FailedFrame(labels[n], "Lost.") for n in ALL if n not in there),
        stopped_early=stopped_early,
        study_frames=study,
    )
    meshes = [ball(radius_mm(n, COUNT)) for n in there]
    carried = {ENDO: tracked_through(meshes, [labels[n] for n in there])}
    return measure(found, options=OPTIONS, warnings=[], provenance=PROVENANCE, tracked=carried)


def steps(collection: Path) -> list[float]:
    return [float(x) for x in re.findall(r'timestep="([^"]+)"', collection.read_text("ascii"))]


@pytest.mark.parametrize("lost", [3, 7, 0])
def test_one_that_failed_changes_neither_period_nor_playing_time(lost: int, tmp_path: Path) -> None:
    there = tuple(n for n in ALL if n != lost)
    measured = part_of(there)
    cycle = measured.report.cycle
    assert cycle is not None
    assert cycle.is_whole_cycle
    assert cycle.period_ms == pytest.approx(PERIOD_MS)
    assert measured.report.function is not None
    rates = cycle.chambers[ENDO]
    whole = part_of(ALL).report.cycle
    assert whole is not None
    true = whole.chambers[ENDO].peak_ejection_rate_ml_per_s
    assert rates.peak_ejection_rate_ml_per_s == pytest.approx(true, rel=0.1)
    write_playback(measured, OPTIONS, tmp_path)
    assert steps(tmp_path / "lv_epi.pvd") == pytest.approx([n * STEP_MS for n in there])
    played = gltf(tmp_path / "cycle.glb")
    check(played)
    assert played.document["nodes"][-1]["extras"]["period_s"] == pytest.approx(PERIOD_MS / 1000.0)
    first, last = (played.shown(at)["lv_endo"] for at in (0.0, PERIOD_MS / 1000.0))
    assert np.array_equal(first, last)


@pytest.mark.parametrize("times", [True, False])
def test_jitter_is_of_neighbours_in_the_study_alone(times: bool) -> None:
    whole = part_of(ALL, times=times).report
    lacking = part_of((0, 1, 2, 3, 4, 6, 7), times=times).report
    assert whole.cycle is not None
    assert lacking.cycle is not None
    volumes = np.array(whole.cycle.surfaces[ENDO].volume_ml, dtype=np.float64)
    around = np.concatenate([volumes[-1:], volumes, volumes[:1]])
    bends = np.diff(around, 2)
    # What F5 has a part in does not count.
    known = np.delete(bends, [4, 5, 6])
    assert lacking.cycle.chambers[ENDO].jitter_ml == pytest.approx(
        float(np.sqrt((known**2).mean() / 6.0))
    )
    scattered = part_of((0, 2, 4, 6), times=times).report.cycle
    assert scattered is not None
    assert scattered.chambers[ENDO].jitter_ml is None


def test_without_times_the_collection_counts_the_frames_of_the_study(tmp_path: Path) -> None:
    write_playback(part_of((0, 1, 2, 5), times=False), OPTIONS, tmp_path)
    assert steps(tmp_path / "lv_endo_tracked.pvd") == [0.0, 1.0, 2.0, 5.0]
    extras = gltf(tmp_path / "cycle.glb").document["nodes"][-1]["extras"]
    assert extras["frames"]["F5"] == pytest.approx(5.0 / COUNT)


@pytest.mark.parametrize("there", [(0, 1, 7), (0, 1, 2, 6, 7)])
def test_what_is_left_of_a_stopped_job_is_no_whole_cycle(
    there: tuple[int, ...], tmp_path: Path
) -> None:
    measured = part_of(there, stopped_early=True)
    report = measured.report
    assert report.stopped_early
    assert report.function is None
    assert report.cycle is not None
    assert not report.cycle.is_whole_cycle
    assert report.cycle.period_ms is None
    assert report.cycle.chambers == {}
    assert report.cycle.surfaces[ENDO].volume_ml[0] is not None
    (said,) = [one.text for one in report.concerns if "end-systole may be among" in one.text]
    assert "`function` and `cycle.chambers` are not given" in said
    assert "`restart` the job" in said
    write_playback(measured, OPTIONS, tmp_path)
    played = gltf(tmp_path / "cycle.glb")
    check(played)
    last_s = there[-1] * STEP_MS / 1000.0
    assert played.document["nodes"][-1]["extras"]["period_s"] == pytest.approx(PERIOD_MS / 1000.0)
    last, end = (played.shown(at) for at in (last_s, PERIOD_MS / 1000.0))
    assert last.keys() == end.keys() == {"lv_endo", "F7_lv_epi"}
    assert np.array_equal(last["lv_endo"], end["lv_endo"])


def test_function_stands_where_both_instants_are_named_and_there() -> None:
    names = {0: "ED", 4: "ES"}
    report = part_of((0, 1, 4), stopped_early=True, names=names).report
    assert report.function is not None
    assert (report.function.ed_frame, report.function.es_frame) == ("ED", "ES")
    assert any("missing: `cycle.chambers` are not" in one.text for one in report.concerns)
    half = part_of((0, 1, 7), stopped_early=True, names=names).report
    assert half.function is None


def test_a_whole_cycle_is_no_concern() -> None:
    report = part_of(ALL).report
    assert not report.stopped_early
    assert not any("stopped" in one.text for one in report.concerns)
