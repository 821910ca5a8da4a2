from dataclasses import replace
from pathlib import Path

import pytest

from schemas.job import Progress
from schemas.media_types import ARTIFACT_MEDIA_TYPES
from schemas.options import Options
from tests.worker.artifacts.mesh_files.gltf_player import check, gltf
from tests.worker.artifacts.page.measured_cycle import measured_cycle
from tests.worker.artifacts.page.measured_phantom import measured_phantom
from worker.artifacts.display_meshes import display_meshes
from worker.artifacts.measured import Measured
from worker.artifacts.playback import write_playback
from worker.observer import Cancelled

ALL = Options.model_validate({"formats": ["stl", "vtp", "glb"]})
COLLECTIONS = {"lv_endo.pvd", "lv_endo_tracked.pvd", "lv_epi.pvd", "rv_endo.pvd"}


@pytest.fixture(scope="module")
def measured() -> Measured:
    return measured_cycle()


@pytest.mark.parametrize(
    ("formats", "names"),
    [
        (["stl", "obj", "ply"], set()),
        (["vtp"], COLLECTIONS),
        (["glb"], {"cycle.glb"}),
        (["glb", "vtp"], COLLECTIONS | {"cycle.glb"}),
    ],
)
def test_what_is_written_follows_the_formats(
    measured: Measured, tmp_path: Path, formats: list[str], names: set[str]
) -> None:
    write_playback(measured, Options.model_validate({"formats": formats}), tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == names
    assert {Path(name).suffix for name in names} <= ARTIFACT_MEDIA_TYPES.keys()


def test_collections_name_the_files_of_their_frames(measured: Measured, tmp_path: Path) -> None:
    write_playback(measured, ALL, tmp_path, "a" * 32)
    text = (tmp_path / "lv_endo_tracked.pvd").read_text(encoding="ascii")
    assert 'timestep="40" group="" part="0" file="F01_lv_endo_tracked.vtp"' in text
    assert "timestep_unit=ms" in text
    assert f"job_id={'a' * 32}" in text
    own = (tmp_path / "lv_endo.pvd").read_text(encoding="ascii")
    assert [own.count(f'"F0{n}_lv_endo.vtp"') for n in range(4)] == [1, 1, 1, 1]


def test_without_times_it_is_the_place_that_counts(tmp_path: Path) -> None:
    write_playback(measured_cycle(times=False), ALL, tmp_path)
    text = (tmp_path / "rv_endo.pvd").read_text(encoding="ascii")
    assert "timestep_unit=frame index" in text
    assert 'timestep="3" group="" part="0" file="F03_rv_endo.vtp"' in text


def test_the_moving_file_holds_tracked_and_other_surfaces(
    measured: Measured, tmp_path: Path
) -> None:
    write_playback(measured, ALL, tmp_path)
    found = gltf(tmp_path / "cycle.glb")
    check(found)
    assert found.shown(0.05).keys() == {"lv_endo", "F01_lv_epi", "F01_rv_endo"}


def test_the_same_again_is_the_same_bytes(measured: Measured, tmp_path: Path) -> None:
    written = []
    for folder in (tmp_path / "one", tmp_path / "two"):
        folder.mkdir()
        write_playback(measured, ALL, folder)
        written.append({path.name: path.read_bytes() for path in folder.iterdir()})
    assert written[0] == written[1]


def test_two_frames_are_no_motion(tmp_path: Path) -> None:
    write_playback(measured_phantom(("ED", "ES"), edge_mm=5.0), ALL, tmp_path)
    assert not list(tmp_path.iterdir())


def test_no_surface_of_three_frames_is_no_moving_file(measured: Measured, tmp_path: Path) -> None:
    bare = replace(measured, frames=[replace(one, surfaces={}) for one in measured.frames])
    write_playback(bare, ALL, tmp_path)
    assert not list(tmp_path.iterdir())


class _Watching:
    """Stops once it was told so many times."""

    def __init__(self, stops_after: int) -> None:
        self.told: list[Progress] = []
        self._stops_after = stops_after

    def advanced(self, progress: Progress) -> None:
        self.told.append(progress)

    def is_cancelled(self) -> bool:
        return len(self.told) >= self._stops_after


def test_it_tells_of_every_surface_and_asks_whether_to_stop(
    measured: Measured, tmp_path: Path
) -> None:
    watching = _Watching(99)
    write_playback(measured, ALL, tmp_path, observer=watching)
    assert [one.fraction for one in watching.told] == [0.0, 1 / 3, 2 / 3]
    stopping = _Watching(2)
    with pytest.raises(Cancelled):
        write_playback(measured, ALL, tmp_path, observer=stopping)
    assert len(stopping.told) == 2


def test_meshes_that_are_thinned_already_are_not_thinned_again(
    measured: Measured, tmp_path: Path
) -> None:
    thinned = display_meshes(measured)
    write_playback(measured, ALL, tmp_path, thinned=thinned)
    given = (tmp_path / "cycle.glb").read_bytes()
    write_playback(measured, ALL, tmp_path)
    assert (tmp_path / "cycle.glb").read_bytes() == given
