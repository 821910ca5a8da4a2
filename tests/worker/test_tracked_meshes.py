"""A study of three frames leaves tracked meshes beside the frames' own."""

import re
from pathlib import Path

import numpy as np
import pytest
import trimesh
from pydantic import ValidationError

from schemas.frame_report import StudyFrame
from schemas.options import Options
from schemas.report import Report
from schemas.vocabulary import Axes, Structure
from tests.worker.artifacts.beating_spheres import frame as spheres
from tests.worker.artifacts.beating_spheres import radius_mm
from worker.crew import Alone
from worker.evaluation.area_share import vertex_areas_mm2
from worker.evaluation.area_spread import area_spread
from worker.mesh_file import read_surface
from worker.observer import Unobserved
from worker.phantom.standard_study import standard_study
from worker.reconstruction.result import Reconstruction
from worker.subject import run
from worker.tracked_meshes import tracked_surfaces

QUICK = {
    "preset": "fast",
    "levels": 2,
    "iterations_per_level": 60,
    "mesh": {"grid_mm": 4.0},
    "formats": ["ply", "vtp", "glb"],
    "surfaces": ["lv_endo"],
    "target_edge_mm": 4.0,
    "tracked_meshes": True,
}


def reported(phases: dict[str, float], out_dir: Path) -> Report:
    study = standard_study(phases, edge_mm=3.0)
    options = Options.model_validate(QUICK)
    return run(study, options, out_dir, threads=1, input_sha256="a" * 64).report


def stored_strain(path: Path) -> np.ndarray:
    """The field of a PLY file, (n,)."""
    stored = trimesh.load_mesh(path, process=False).metadata["_ply_raw"]["vertex"]["data"]
    return np.asarray(stored["area_strain"], dtype=np.float64)


def test_every_frame_has_the_same_triangles_in_another_place(tmp_path: Path) -> None:
    report = reported({"ED": 0.0, "A": 0.5, "ES": 1.0}, tmp_path)
    tracked = report.tracking[Structure.LV_ENDO]
    assert tracked.rest_frame == "ED"
    assert "twist" in tracked.not_observed
    assert list(tracked.frames) == ["ED", "A", "ES"]
    meshes = [read_surface(tmp_path / f"{frame}_lv_endo_tracked.ply") for frame in tracked.frames]
    for frame, mesh in zip(tracked.frames, meshes, strict=True):
        assert (mesh.faces == meshes[0].faces).all()
        assert len(mesh.vertices_mm) == tracked.vertices
        measured = tracked.frames[frame]
        assert measured.to_surface_mm.mean < 0.2
        assert (measured.turned_over, measured.self_intersections) == (0, 0)
        assert measured.fit == (not measured.reasons)
    own = read_surface(tmp_path / "ED_lv_endo.ply")
    assert np.array_equal(own.vertices_mm, meshes[0].vertices_mm)
    assert not any("tracked" in warning for warning in report.warnings)
    assert report.cycle is not None
    strain = report.cycle.surfaces[Structure.LV_ENDO].area_strain_percent
    assert strain is not None
    for index, (frame, mesh) in enumerate(zip(tracked.frames, meshes, strict=True)):
        at_vertices = stored_strain(tmp_path / f"{frame}_lv_endo_tracked.ply")
        assert len(at_vertices) == len(mesh.vertices_mm)
        spread = area_spread(vertex_areas_mm2(meshes[0]), 100.0 * at_vertices)
        assert spread.mean == pytest.approx(strain.mean[index], abs=1e-2)
        assert spread.p95 == pytest.approx(strain.p95[index], abs=1e-2)
    assert strain.mean[0] == 0.0
    assert strain.mean[2] < strain.mean[1] < 0.0


def test_viewers_find_every_frame_in_what_they_play(tmp_path: Path) -> None:
    reported({"ED": 0.0, "A": 0.5, "ES": 1.0}, tmp_path)
    for ending in ("", "_tracked"):
        collection = (tmp_path / f"lv_endo{ending}.pvd").read_text(encoding="ascii")
        named = re.findall(r'file="([^"]+)"', collection)
        assert named == [f"{frame}_lv_endo{ending}.vtp" for frame in ("ED", "A", "ES")]
        assert all((tmp_path / name).is_file() for name in named)
    played = trimesh.load_scene(tmp_path / "cycle.glb").geometry["lv_endo"]
    own = read_surface(tmp_path / "ED_lv_endo_tracked.ply")
    assert np.abs(played.vertices - own.vertices_mm).max() < 1e-4


@pytest.mark.parametrize("stopped_early", [True, False])
def test_what_is_left_of_a_stopped_job_is_not_tracked_over_the_gap(stopped_early: bool) -> None:
    """Of eight frames F0, F1 and F7, sent as F7, F0, F1: side by side, with no way round."""
    study = tuple(StudyFrame(label=f"F{n}", time_ms=100.0 * n) for n in range(8))
    found = Reconstruction(
        "case-01",
        Axes.LPS,
        tuple(spheres(n, 8, (Structure.LV_ENDO,)) for n in (7, 0, 1)),
        stopped_early=stopped_early,
        study_frames=study,
    )
    options = Options.model_validate({"tracked_meshes": True, "target_edge_mm": 4.0})
    tracked, _ = tracked_surfaces(found, options, Unobserved(), Alone())
    one = tracked[Structure.LV_ENDO]
    assert one.frames[one.rest].label == "F0"
    if stopped_early:
        assert [each.label for each in one.frames] == ["F7", "F0", "F1"]
        assert one.drift_mean_mm is None
    else:
        assert [each.label for each in one.frames] == ["F0", "F1", "F7"]
        assert one.drift_mean_mm is not None
    for each, mesh in zip(one.frames, map(one.mesh, range(3)), strict=True):
        radii = np.linalg.norm(mesh.vertices_mm, axis=1)
        assert radii.mean() == pytest.approx(radius_mm(int(each.label[1:]), 8), rel=0.01)


def test_two_frames_are_too_few_and_it_is_said(tmp_path: Path) -> None:
    report = reported({"ED": 0.0, "ES": 1.0}, tmp_path)
    assert not report.tracking
    assert any("lv_endo was not tracked: 2 frames" in warning for warning in report.warnings)
    assert not list(tmp_path.glob("*_tracked*"))


def test_an_open_base_is_refused() -> None:
    with pytest.raises(ValidationError, match="leave `base` closed"):
        Options.model_validate({"base": "open", "tracked_meshes": True})
