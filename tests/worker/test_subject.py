"""The whole of a job but the job: the phantom in, files out."""

from pathlib import Path

import pytest
import pyvista

from intake.limits import Limits
from schemas.job import Progress, Stage
from schemas.options import Options
from schemas.problem import InputError
from schemas.report import Report
from schemas.study import ContourStudy
from schemas.vocabulary import MeshFormat, View
from worker.observer import Cancelled
from worker.phantom.beating import Beat, BeatingHeart, sliced_beat
from worker.phantom.shape import HeartShape
from worker.phantom.standard_study import standard_study
from worker.subject import Finished, run

QUICK = Options.model_validate(
    {
        "preset": "fast",
        "levels": 2,
        "iterations_per_level": 60,
        "mesh": {"grid_mm": 4.0},
        "formats": list(MeshFormat),
    }
)


class Watcher:
    """Remembers progress; asks to stop once the stage is reached."""

    def __init__(self, stop_at: Stage | None = None) -> None:
        self.seen: list[Progress] = []
        self.stop_at = stop_at

    def advanced(self, progress: Progress) -> None:
        self.seen.append(progress)

    def is_cancelled(self) -> bool:
        return self.stop_at in [p.stage for p in self.seen]


@pytest.fixture(scope="module")
def study() -> ContourStudy:
    return standard_study(edge_mm=3.0)


def reconstructed(
    study: ContourStudy, out_dir: Path, watcher: Watcher, options: Options = QUICK
) -> Finished:
    out_dir.mkdir()
    return run(
        study,
        options,
        out_dir,
        threads=1,
        input_sha256="a" * 64,
        warnings=["noticed before"],
        observer=watcher,
    )


def test_a_study_becomes_files_that_the_manifest_lists(study: ContourStudy, tmp_path: Path) -> None:
    watcher = Watcher()
    finished = reconstructed(study, tmp_path / "out", watcher)

    names = {a.name for a in finished.manifest.artifacts}
    assert names == {p.name for p in (tmp_path / "out").iterdir()}
    meshes = {f for s in finished.report.frames[0].surfaces.values() for f in s.files}
    assert names == meshes | {"report.json", "report.html"}
    assert len(meshes) == 3 * len(MeshFormat)
    written = Report.model_validate_json((tmp_path / "out" / "report.json").read_text())
    assert written == finished.report
    assert finished.report.warnings[0] == "noticed before"
    assert {"fitting", "meshing", "measuring", "total"} <= set(finished.report.timings_s)
    assert finished.report.provenance.threads == 1
    fractions = [p.fraction for p in watcher.seen]
    assert fractions == sorted(fractions), "progress never goes back"
    assert (fractions[0], fractions[-1]) == (0.0, 1.0)
    assert [*dict.fromkeys(p.stage for p in watcher.seen)] == [
        Stage.READING,
        Stage.FITTING,
        Stage.MESHING,
        Stage.MEASURING,
        Stage.WRITING,
        Stage.DONE,
    ]
    labels = [one.label for one in finished.report.frames]
    for stage in (Stage.MEASURING, Stage.WRITING):
        told = [p.frame for p in watcher.seen if p.stage is stage and p.frame]
        assert [*dict.fromkeys(told)] == labels, "frame by frame"


def test_the_same_again_is_the_same_bytes(study: ContourStudy, tmp_path: Path) -> None:
    reconstructed(study, tmp_path / "one", Watcher())
    reconstructed(study, tmp_path / "two", Watcher())
    meshes = [p for p in (tmp_path / "one").iterdir() if not p.name.startswith("report")]
    assert meshes
    for path in meshes:
        assert path.read_bytes() == (tmp_path / "two" / path.name).read_bytes(), path.name


@pytest.mark.slow
def test_two_processes_write_the_same_bytes(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """All that several processes may share: chains, tracking, measuring, writing, drawing."""
    beats = sliced_beat(BeatingHeart(HeartShape(), Beat()), 4, edge_mm=3.0).sliced.study
    options = QUICK.model_copy(update={"tracked_meshes": True, "ensemble": 1})
    found = {}
    for processes in (1, 2):
        out_dir = tmp_path / str(processes)
        out_dir.mkdir()
        run(beats, options, out_dir, threads=1, processes=processes, input_sha256="a" * 64)
        found[processes] = {p.name: p.read_bytes() for p in sorted(out_dir.iterdir())}
    assert not caplog.records, "no helper was lost"
    assert found[1].keys() == found[2].keys()
    # These two tell how long it took.
    differ = {name for name, content in found[1].items() if content != found[2][name]}
    assert differ <= {"report.json", "report.html"}
    reports = [Report.model_validate_json(files["report.json"]) for files in found.values()]
    one, other = (report.model_copy(update={"timings_s": {}}) for report in reports)
    assert one == other


@pytest.mark.parametrize("stage", [Stage.READING, Stage.FITTING, Stage.MESHING])
def test_it_stops_where_it_is_asked_to(stage: Stage, study: ContourStudy, tmp_path: Path) -> None:
    watcher = Watcher(stop_at=stage)
    with pytest.raises(Cancelled):
        reconstructed(study, tmp_path / "out", watcher)
    assert Stage.DONE not in [p.stage for p in watcher.seen]


def test_the_limits_given_are_the_limits_held(study: ContourStudy, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="at most 100 are accepted"):
        run(
            study,
            QUICK,
            tmp_path,
            threads=1,
            input_sha256="a" * 64,
            limits=Limits(max_points=100),
        )


def test_a_study_that_cannot_be_reconstructed_is_refused_at_the_door(
    study: ContourStudy, tmp_path: Path
) -> None:
    frame = study.frames[0]
    alone = study.model_copy(
        update={"frames": [frame.model_copy(update={"slices": frame.slices[:1]})]}
    )
    watcher = Watcher()
    with pytest.raises(InputError) as refused:
        reconstructed(alone, tmp_path / "out", watcher)
    assert refused.value.pointer is not None
    assert refused.value.pointer.startswith("/study/frames/0")
    assert Stage.FITTING not in [p.stage for p in watcher.seen]


def test_support_is_at_every_vertex_of_the_files_that_can_hold_it(
    study: ContourStudy, tmp_path: Path
) -> None:
    finished = reconstructed(study, tmp_path / "out", Watcher())
    for name, surface in finished.report.frames[0].surfaces.items():
        path = tmp_path / "out" / f"ED_{name}.vtp"
        support_mm = pyvista.XMLPolyDataReader(str(path)).read().point_data["support_mm"]
        assert len(support_mm) == surface.vertices
        assert float(support_mm.max()) == pytest.approx(surface.support_mm.max, abs=1e-4)
        header = (tmp_path / "out" / f"ED_{name}.ply").read_bytes()[:2000]
        assert b"property float support_mm" in header


def test_short_axis_slices_alone_are_warned_of_and_long_axis_slices_are_not(
    study: ContourStudy, tmp_path: Path
) -> None:
    frame = study.frames[0]
    across = [s for s in frame.slices if s.view is View.SAX]
    alone = study.model_copy(update={"frames": [frame.model_copy(update={"slices": across})]})
    # Fitted well enough that surfaces end where the long-axis slices say.
    options = Options.model_validate({"preset": "fast", "mesh": {"grid_mm": 4.0}})
    whole = reconstructed(study, tmp_path / "whole", Watcher(), options).report
    report = reconstructed(alone, tmp_path / "alone", Watcher(), options).report
    assert not [w for w in whole.warnings if "extrapolated" in w]
    told = [w for w in report.warnings if "extrapolated" in w]
    assert len(told) == len(report.frames[0].surfaces) == 3
    assert all("apex" in w and "mm from the nearest contour" in w for w in told)
