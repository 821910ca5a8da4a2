"""What a track that is known is told of: an exact one has no error, a shifted one its shift."""

import numpy as np
import pytest

from benchmarks.beating.paths import path_errors, true_paths
from benchmarks.beating.phantom_beats import true_volumes_ml
from schemas.vocabulary import Structure
from worker.evaluation.area_share import vertex_areas_mm2
from worker.evaluation.size import volume_ml
from worker.evaluation.surface_normals import unit
from worker.phantom.beating import PRESETS, BeatingHeart, BeatPreset, SlicedBeat, sliced_beat
from worker.phantom.slicing_plan import SlicingPlan
from worker.tracking.area_strain import area_strain
from worker.tracking.tracked_surface import TrackedSurface

COARSE = SlicingPlan(spacing_mm=30.0, long_axis_planes=0)


@pytest.fixture(scope="module", params=list(BeatPreset))
def heart(request: pytest.FixtureRequest) -> BeatingHeart:
    case = PRESETS[request.param]
    return BeatingHeart(case.shape, case.beat)


@pytest.fixture(scope="module")
def beat(heart: BeatingHeart) -> SlicedBeat:
    return sliced_beat(heart, 5, COARSE, edge_mm=2.0)


def exact(beat: SlicedBeat, structure: Structure) -> TrackedSurface:
    moving = beat.surfaces[structure]
    return TrackedSurface(moving.vertices_mm, moving.faces, 0, (), None, None)


@pytest.mark.parametrize("structure", [Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO])
def test_an_exact_track_has_no_error_of_place_and_hardly_one_of_strain(
    heart: BeatingHeart, beat: SlicedBeat, structure: Structure
) -> None:
    tracked = exact(beat, structure)
    at_rest = tracked.mesh(0)
    paths = true_paths(heart, structure, at_rest, at_rest.vertices_mm, beat.times_ms)
    errors = path_errors(tracked.vertices_mm, paths.positions_mm, paths.normals)
    assert errors.length_mm.max() < 1e-4
    np.testing.assert_allclose(np.linalg.norm(paths.normals, axis=2), 1.0, atol=1e-9)
    areas_mm2 = vertex_areas_mm2(at_rest)
    off = np.abs(area_strain(tracked, 0) - (paths.area_ratio - 1.0)) @ areas_mm2 / areas_mm2.sum()
    # Areas of triangles of 2 mm beside those at points.
    assert off.max() < 0.03
    assert off[0] < 1e-6


def test_what_moves_along_the_normal_is_told_from_what_slides() -> None:
    rng = np.random.default_rng(1)
    true = rng.normal(size=(3, 40, 3))
    normals = unit(rng.normal(size=(120, 3))).reshape(3, 40, 3)
    across = unit(np.cross(normals.reshape(-1, 3), [0.0, 0.0, 1.0])).reshape(3, 40, 3)
    outward = path_errors(true + 2.0 * normals, true, normals)
    np.testing.assert_allclose(outward.normal_mm, 2.0)
    np.testing.assert_allclose(outward.tangential_mm, 0.0, atol=1e-12)
    slid = path_errors(true - 3.0 * across, true, normals)
    np.testing.assert_allclose(slid.normal_mm, 0.0, atol=1e-12)
    np.testing.assert_allclose(slid.tangential_mm, 3.0)
    both = path_errors(true - 4.0 * normals + 3.0 * across, true, normals)
    np.testing.assert_allclose(both.length_mm, 5.0)


def test_points_beside_the_surface_are_taken_for_those_nearest_to_them(
    heart: BeatingHeart, beat: SlicedBeat
) -> None:
    surface = beat.surfaces[Structure.RV_ENDO].frame(0)
    on = surface.triangles_mm.mean(axis=1)[::50]
    a, b, c = (surface.triangles_mm[::50, corner] for corner in range(3))
    beside = on + 0.05 * unit(np.cross(b - a, c - a))
    one, other = (
        true_paths(heart, Structure.RV_ENDO, surface, points, beat.times_ms)
        for points in (on, beside)
    )
    np.testing.assert_allclose(one.positions_mm, other.positions_mm, atol=1e-6)


def test_a_mesh_that_grows_as_a_whole_is_strained_evenly_from_any_frame() -> None:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    grown = np.stack([corners, 1.1 * corners, 1.2 * corners])
    tracked = TrackedSurface(grown, faces, 2, (), None, None)
    np.testing.assert_allclose(area_strain(tracked, 0)[:, 0], [0.0, 0.21, 0.44])


def test_exact_volumes_are_those_of_fine_meshes(heart: BeatingHeart, beat: SlicedBeat) -> None:
    for structure, volumes in true_volumes_ml(heart, beat).items():
        moving = beat.surfaces[structure]
        meshed = [volume_ml(moving.frame(index)) for index in range(5)]
        np.testing.assert_allclose(meshed, volumes, rtol=0.01)
