from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from schemas.vocabulary import Axes, Structure
from tests.worker.artifacts.mesh_files.gltf_player import Gltf, check, gltf
from tests.worker.artifacts.page.example_report import frame_report
from tests.worker.tracking.ellipsoids import Beat, own_surface, phases, sphere
from worker.artifacts.frame_times import FrameTimes, frame_times
from worker.artifacts.mesh_files.moving_glb import write_moving_glb
from worker.artifacts.moving_surface import MovingSurface
from worker.surface_mesh import SurfaceMesh

COUNT = 6
TIMES = frame_times(
    [
        frame_report(f"F{n}", time_ms=time)
        for n, time in enumerate((10.0, 45.0, 80.0, 115.0, 151.0, 185.0))
    ],
    is_whole_cycle=True,
)
PART = replace(TIMES, is_whole_cycle=False, period_ms=None)
PLACE_MM = np.array([130.0, -250.0, 1800.0])


def endo() -> MovingSurface:
    """Tracked, as far from the origin as a scanner may put it."""
    vertices, faces = sphere(3)
    moved = [
        SurfaceMesh(Beat().at(vertices, phase, outer=False) + PLACE_MM, faces)
        for phase in phases(COUNT)
    ]
    return MovingSurface(Structure.LV_ENDO, tuple(range(COUNT)), tuple(moved), is_tracked=True)


def epi() -> MovingSurface:
    """Not tracked, and not there in the third frame."""
    frames = (0, 1, 3, 4, 5)
    meshes = tuple(own_surface(Beat(), float(phases(COUNT)[f]), outer=True) for f in frames)
    return MovingSurface(Structure.LV_EPI, frames, meshes, is_tracked=False)


def written(folder: Path, *surfaces: MovingSurface, times: FrameTimes = TIMES) -> Gltf:
    path = folder / "cycle.glb"
    write_moving_glb(path, surfaces, times, Axes.LPS, job_id="0" * 32)
    return gltf(path)


@pytest.mark.parametrize("times", [TIMES, replace(PART, times_ms=None)])
def test_it_keeps_the_rules_of_the_format(tmp_path: Path, times: FrameTimes) -> None:
    check(written(tmp_path, endo(), epi(), times=times))


def test_at_every_frame_s_time_vertices_are_where_they_are_in_the_frame(tmp_path: Path) -> None:
    surface = endo()
    found = written(tmp_path, surface)
    fineness_mm = 2.0 ** (12 - 24)
    for seconds, mesh in zip(TIMES.seconds, surface.meshes, strict=True):
        positions = found.shown(seconds)["lv_endo"]
        on_grid = np.rint(mesh.vertices_mm / fineness_mm) * fineness_mm
        assert positions.dtype == np.float32
        assert np.array_equal(positions, on_grid.astype("f4"))
        assert np.abs(positions - mesh.vertices_mm).max() <= fineness_mm / 2


def test_in_between_vertices_are_in_between_and_the_end_is_the_beginning(tmp_path: Path) -> None:
    surface = endo()
    found = written(tmp_path, surface)
    half = found.shown((TIMES.seconds[1] + TIMES.seconds[2]) / 2)["lv_endo"]
    mean = (surface.meshes[1].vertices_mm + surface.meshes[2].vertices_mm) / 2
    np.testing.assert_allclose(half, mean, atol=1e-3)
    first, last = (found.shown(at)["lv_endo"] for at in (0.0, TIMES.period_s))
    assert np.array_equal(first, last)


def test_a_surface_without_the_first_frame_goes_on_over_the_seam(tmp_path: Path) -> None:
    """Its last frame is at 175 ms, its first at 35 ms of a beat of 210 ms: half-way at the end."""
    whole = endo()
    frames = (1, 2, 3, 4, 5)
    surface = replace(whole, frames=frames, meshes=whole.meshes[1:])
    found = written(tmp_path, surface)
    check(found)
    middle = (whole.meshes[5].vertices_mm + whole.meshes[1].vertices_mm) / 2
    for at in (0.0, TIMES.period_s):
        np.testing.assert_allclose(found.shown(at)["lv_endo"], middle, atol=1e-3)
    for frame in frames:
        there = found.shown(TIMES.seconds[frame])["lv_endo"]
        np.testing.assert_allclose(there, whole.meshes[frame].vertices_mm, atol=2e-4)


def test_an_untracked_surface_without_the_first_frame_is_not_there_at_the_seam(
    tmp_path: Path,
) -> None:
    whole = epi()
    found = written(tmp_path, replace(whole, frames=whole.frames[1:], meshes=whole.meshes[1:]))
    for at in (0.0, TIMES.seconds[2], TIMES.period_s):
        assert list(found.shown(at)) == []
    assert list(found.shown(TIMES.seconds[5])) == ["F5_lv_epi"]


def test_what_is_no_whole_cycle_ends_as_it_ended(tmp_path: Path) -> None:
    found = written(tmp_path, endo(), epi(), times=PART)
    last, end = (found.shown(at) for at in (TIMES.seconds[-1], TIMES.period_s))
    assert last.keys() == end.keys() == {"lv_endo", "F5_lv_epi"}
    assert np.array_equal(last["lv_endo"], end["lv_endo"])


def test_of_an_untracked_surface_one_frame_is_there_at_a_time(tmp_path: Path) -> None:
    surface = epi()
    found = written(tmp_path, surface)
    for place, mesh in zip(surface.frames, surface.meshes, strict=True):
        shown = found.shown(TIMES.seconds[place] + 0.01)
        assert list(shown) == [f"F{place}_lv_epi"]
        assert np.array_equal(shown[f"F{place}_lv_epi"], mesh.vertices_mm.astype("f4"))
    assert list(found.shown(TIMES.seconds[2])) == [], "no other frame's in its stead"
    assert list(found.shown(TIMES.period_s)) == ["F0_lv_epi"]


def test_a_viewer_that_plays_nothing_shows_the_first_frame(tmp_path: Path) -> None:
    surfaces = [endo(), epi()]
    document = written(tmp_path, *surfaces).document
    assert not any(document["meshes"][0]["weights"])
    scales = [node.get("scale", [1, 1, 1])[0] for node in document["nodes"][1:-1]]
    assert scales == [1, 0, 0, 0, 0]
    scene = trimesh.load_scene(tmp_path / "cycle.glb")
    assert set(scene.geometry) == {"lv_endo"} | {f"F{n}_lv_epi" for n in (0, 1, 3, 4, 5)}
    first = scene.geometry["lv_endo"]
    np.testing.assert_allclose(first.vertices, surfaces[0].meshes[0].vertices_mm, atol=2e-4)
    assert first.is_watertight
    assert first.volume > 0
    # In metres, the head up: the centre's z of 1.8 m is the height.
    placed = scene.graph.get("lv_endo")[0]
    height = (placed @ np.append(first.centroid, 1.0))[1]
    assert height == pytest.approx(first.centroid[2] / 1000.0)


def test_walls_are_glass_and_the_file_says_when_frames_are(tmp_path: Path) -> None:
    document = written(tmp_path, endo(), epi()).document
    assert [m.get("alphaMode") for m in document["materials"]] == [None, "BLEND"]
    heart = document["nodes"][-1]
    assert heart["extras"]["frames"]["F2"] == pytest.approx(0.07)
    assert heart["extras"]["period_s"] == pytest.approx(0.21)
    assert document["asset"]["extras"]["job_id"] == "0" * 32
    assert document["meshes"][0]["extras"]["targetNames"] == ["F1", "F2", "F3", "F4", "F5"]
