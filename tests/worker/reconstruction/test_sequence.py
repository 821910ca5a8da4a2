"""Each frame is found as by itself, from its neighbour; one that fails fails alone."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import torch

from schemas.job import Progress
from schemas.options import Options
from schemas.problem import InternalError, ProblemType
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from tests.worker.kept import Kept
from worker.helped_crew import crew_of
from worker.observer import Cancelled
from worker.reconstruction import frame_pipeline
from worker.reconstruction.pipeline import reconstruct
from worker.reconstruction.result import FailedFrame, Reconstruction, StoppedEarly

RADII_MM = {"F0": 25.0, "F1": 24.0, "F2": 23.0, "F3": 24.0}
CENTRE_MM = np.array([12.0, -30.0, 55.0])


@pytest.fixture
def beating(concentric_spheres) -> Callable[..., ContourStudy]:
    """Makes a study of spheres of the given radii, frame by frame, on the same slices."""

    def make(radii_mm: dict[str, float] = RADII_MM, **made: object) -> ContourStudy:
        frames = []
        for label, radius_mm in radii_mm.items():
            one = concentric_spheres(endo_mm=radius_mm, epi_mm=radius_mm + 10.0, **made)
            frames.append({**one.model_dump(mode="json")["frames"][0], "label": label})
        document = one.model_dump(mode="json")
        return ContourStudy.model_validate({**document, "frames": frames})

    return make


@pytest.fixture
def small(quick: Options) -> Options:
    """For what does not depend on how near a surface comes."""
    mesh = quick.mesh.model_copy(update={"grid_mm": 4.0})
    return quick.model_copy(update={"levels": 2, "iterations_per_level": 15, "mesh": mesh})


def with_sequence(options: Options, **chosen: object) -> Options:
    sequence = options.sequence.model_copy(update=chosen)
    return options.model_copy(update={"sequence": sequence})


def errors_mm(found: Reconstruction) -> dict[str, float]:
    return {
        frame.label: float(
            np.abs(
                np.linalg.norm(frame.surfaces[Structure.LV_ENDO].vertices_mm - CENTRE_MM, axis=1)
                - RADII_MM[frame.label]
            ).mean()
        )
        for frame in found.frames
    }


def test_each_frame_goes_on_from_its_neighbour_and_finds_its_own_surface(
    beating, quick: Options
) -> None:
    found = reconstruct(beating(), quick)
    assert {frame.label: frame.started_from for frame in found.frames} == {
        "F0": None,
        "F1": "F0",
        "F2": "F1",
        "F3": "F0",
    }
    assert max(errors_mm(found).values()) < 0.5
    assert not found.failed
    assert not found.warnings


def test_without_warm_starts_every_frame_is_fitted_from_nothing(beating, small: Options) -> None:
    found = reconstruct(beating(), with_sequence(small, warm_start=False))
    assert {frame.started_from for frame in found.frames} == {None}


def test_two_frames_are_both_fitted_from_nothing(beating, small: Options) -> None:
    found = reconstruct(beating({"F0": 25.0, "F2": 23.0}), small)
    assert {frame.started_from for frame in found.frames} == {None}


def test_a_slice_has_one_shift_in_every_frame(beating, quick: Options) -> None:
    study = beating(displacements={3: (2.0, 1.0), 6: (-1.0, 2.0)})
    found = reconstruct(study, quick)
    for slices in zip(*(frame.slices for frame in found.frames), strict=True):
        for one in slices[1:]:
            np.testing.assert_array_equal(one.shift_mm, slices[0].shift_mm)
    shifts = {one.id: one.shift_mm for one in found.frames[0].slices}
    np.testing.assert_allclose(shifts["sax-03"], [2.0, 1.0, 0.0], atol=0.2)


@pytest.mark.parametrize("long_axis", [True, False])
def test_a_sequence_that_was_interrupted_ends_as_one_that_was_not(
    beating, small: Options, long_axis: bool
) -> None:
    study = beating(displacements={3: (2.0, 1.0)}, long_axis=long_axis)
    kept = Kept()
    unbroken = reconstruct(study, small)
    with pytest.raises(Cancelled):
        reconstruct(study, small, StopsIn("F2"), kept)
    assert {"frame-F0-fit", "frame-F1-fit"} <= kept.held.keys()
    already = {key: len(content) for key, content in kept.saved.items()}
    resumed = reconstruct(study, small, None, kept)
    assert len(kept.saved["frame-F0-fit"]) == already["frame-F0-fit"]
    assert len(kept.saved["frame-F1-fit"]) == already["frame-F1-fit"]
    for one, other in zip(unbroken.frames, resumed.frames, strict=True):
        for structure, mesh in one.surfaces.items():
            again = other.surfaces[structure]
            np.testing.assert_array_equal(mesh.vertices_mm, again.vertices_mm)


@pytest.fixture
def fail_in(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Lets the fits of these frames enclose nothing."""

    def fail(*labels: str) -> None:
        found = frame_pipeline.surfaces_of

        def surfaces_of(*given: Any, **more: Any) -> Any:
            observer = given[-1]
            if observer.label in labels:
                raise InternalError(ProblemType.NO_SURFACE, f"{observer.label} is empty.")
            return found(*given, **more)

        monkeypatch.setattr(frame_pipeline, "surfaces_of", surfaces_of)

    return fail


def test_a_frame_that_fails_fails_alone(beating, small: Options, fail_in) -> None:
    fail_in("F1")
    found = reconstruct(beating(), small)
    assert [frame.label for frame in found.frames] == ["F0", "F2", "F3"]
    assert found.failed == (FailedFrame("F1", "F1 is empty."),)
    # F2 would have gone on from it.
    assert [frame.started_from for frame in found.frames] == [None, "F0", "F0"]


def test_a_study_of_frames_that_all_fail_fails(beating, small: Options, fail_in) -> None:
    fail_in(*RADII_MM)
    with pytest.raises(InternalError, match="F0 is empty"):
        reconstruct(beating(), small)


def test_a_store_that_does_not_answer_is_no_fault_of_a_frame(beating, small: Options) -> None:
    class Unanswered(Kept):
        def save(self, key: str, content: bytes) -> None:
            raise InternalError(ProblemType.STORE_UNAVAILABLE, "It does not answer.")

    with pytest.raises(InternalError, match="does not answer"):
        reconstruct(beating(), small, None, Unanswered())


def test_the_error_of_a_frame_alone_is_raised(beating, small: Options, fail_in) -> None:
    fail_in("F0")
    with pytest.raises(InternalError, match="F0 is empty"):
        reconstruct(beating({"F0": 25.0}), small)


@pytest.mark.parametrize("processes", [1, 2])
def test_the_frames_that_were_finished_are_kept_where_it_is_stopped(
    beating, small: Options, processes: int
) -> None:
    unbroken = reconstruct(beating(), small)
    # With a helper this process has F1 and F2, or F3: whichever the helper was not ready for.
    stops_in = StopsIn(*(["F2"] if processes == 1 else ["F1", "F3"]))
    with (
        crew_of(processes, torch.get_num_threads()) as crew,
        pytest.raises(StoppedEarly) as caught,
    ):
        reconstruct(beating(), small, stops_in, None, crew)
    found = caught.value.found
    kept = {frame.label: frame for frame in found.frames}
    assert {"F0"} <= kept.keys() < set(RADII_MM)
    assert {one.label for one in found.failed} == set(RADII_MM) - kept.keys()
    assert all("when the job was cancelled" in one.reason for one in found.failed)
    assert found.stopped_early
    assert [one.label for one in found.study_frames] == list(RADII_MM)
    for frame in unbroken.frames:
        if frame.label in kept:
            for structure, mesh in frame.surfaces.items():
                again = kept[frame.label].surfaces[structure]
                np.testing.assert_array_equal(mesh.vertices_mm, again.vertices_mm)


def test_where_it_is_stopped_before_a_frame_is_finished_nothing_is_kept(
    beating, small: Options
) -> None:
    with pytest.raises(Cancelled) as caught:
        reconstruct(beating(), small, StopsIn("F0"))
    assert not isinstance(caught.value, StoppedEarly)


def test_progress_goes_through_the_frames_and_never_back(beating, small: Options) -> None:
    told = Listener()
    reconstruct(beating(), small, told)
    fractions = [progress.fraction for progress in told.told]
    assert fractions == sorted(fractions)
    assert list(dict.fromkeys(progress.frame for progress in told.told)) == ["F0", "F1", "F2", "F3"]


@pytest.mark.parametrize("chosen", [{}, {"warm_start": False}])
def test_whoever_fits_a_frame_its_surfaces_are_the_same_bytes(
    beating, small: Options, chosen: dict[str, bool], caplog: pytest.LogCaptureFixture
) -> None:
    study, options = beating(displacements={3: (2.0, 1.0)}), with_sequence(small, **chosen)
    kept = Kept()
    alone = reconstruct(study, options)
    with crew_of(2, torch.get_num_threads()) as crew:
        helped = reconstruct(study, options, None, kept, crew)
    assert {f"frame-{label}-fit" for label in RADII_MM} <= kept.held.keys()
    assert not caplog.records, "no helper was lost"
    for one, other in zip(alone.frames, helped.frames, strict=True):
        assert one.started_from == other.started_from
        for structure, mesh in one.surfaces.items():
            np.testing.assert_array_equal(mesh.vertices_mm, other.surfaces[structure].vertices_mm)


class Listener:
    def __init__(self) -> None:
        self.told: list[Progress] = []

    def advanced(self, progress: Progress) -> None:
        self.told.append(progress)

    def is_cancelled(self) -> bool:
        return False


class StopsIn(Listener):
    """Asks to stop once one of these frames is begun."""

    def __init__(self, *labels: str) -> None:
        super().__init__()
        self._labels = labels

    def is_cancelled(self) -> bool:
        return bool(self.told) and self.told[-1].frame in self._labels
