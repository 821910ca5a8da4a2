from dataclasses import replace

import numpy as np
import pytest

from schemas.vocabulary import Structure
from tests.worker.artifacts.page.measured_cycle import measured_cycle
from worker.artifacts.frame_times import frame_times
from worker.artifacts.measured import Measured
from worker.artifacts.moving_surface import MovingSurface, moving_surfaces


def moving(measured: Measured) -> dict[Structure, MovingSurface]:
    times = frame_times(measured.report.frames, is_whole_cycle=True)
    return {one.structure: one for one in moving_surfaces(measured, times)}


@pytest.fixture(scope="module")
def measured() -> Measured:
    return measured_cycle()


def test_tracked_meshes_are_taken_where_there_are_any(measured: Measured) -> None:
    found = moving(measured)
    assert [one.is_tracked for one in found.values()] == [True, False, False]
    tracked = measured.tracked[Structure.LV_ENDO]
    for frame, mesh in enumerate(found[Structure.LV_ENDO].meshes):
        assert np.array_equal(mesh.vertices_mm, tracked.vertices_mm[frame])
    for one in found.values():
        assert one.frames == (0, 1, 2, 3)


def test_a_frame_without_results_is_left_out_of_the_tracked(measured: Measured) -> None:
    report = measured.report.model_copy(update={"frames": measured.report.frames[1:]})
    found = moving(replace(measured, report=report, frames=measured.frames[1:]))
    endo = found[Structure.LV_ENDO]
    assert endo.frames == (0, 1, 2)
    assert np.array_equal(
        endo.meshes[0].vertices_mm, measured.tracked[Structure.LV_ENDO].vertices_mm[1]
    )


def test_a_surface_of_two_frames_does_not_move(measured: Measured) -> None:
    bare = [replace(frame, surfaces={}) for frame in measured.frames[:2]]
    assert moving(replace(measured, frames=[*bare, *measured.frames[2:]])) == {}
