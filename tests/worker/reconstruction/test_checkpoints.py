"""A fit that goes on from a checkpoint ends as one that was never interrupted, bit for bit."""

from itertools import pairwise

import numpy as np
import pytest
import torch

from schemas.job import Progress, Stage
from schemas.options import Options
from schemas.study import ContourStudy
from tests.worker.kept import Kept
from worker.observer import Cancelled
from worker.reconstruction import field_problem
from worker.reconstruction.pipeline import reconstruct
from worker.reconstruction.result import FrameFit, Reconstruction

LEVELS = 3
FIT = "frame-ED-fit"


@pytest.fixture(scope="module")
def study(concentric_spheres) -> ContourStudy:
    """Displaced slices, so that shifts are learned, too."""
    return concentric_spheres(displacements={3: (2.0, 1.0), 6: (-1.0, 2.0)}, long_axis=False)


def options_of(**changed: object) -> Options:
    return Options.model_validate(
        {
            "levels": LEVELS,
            "iterations_per_level": 12,
            "optimizer": {"samples_per_step": 512},
            "network": {"width": 24, "depth": 3},
            "alignment": {"first_level": 0},
            "mesh": {"grid_mm": 3.5},
            **changed,
        }
    )


def assert_same(a: Reconstruction, b: Reconstruction) -> None:
    for one, other in zip(a.frames, b.frames, strict=True):
        assert one.surfaces.keys() == other.surfaces.keys()
        for structure in one.surfaces:
            assert_same_mesh(one.surfaces[structure], other.surfaces[structure])
        for level, again in zip(one.levels, other.levels, strict=True):
            assert level.samples == again.samples
            np.testing.assert_array_equal(level.total, again.total)
        for slice_, twin in zip(one.slices, other.slices, strict=True):
            np.testing.assert_array_equal(slice_.shift_mm, twin.shift_mm)
            assert slice_.turn_rad == twin.turn_rad
        for surfaces, others in zip(refits(one), refits(other), strict=True):
            assert surfaces.keys() == others.keys()
            for structure in surfaces:
                assert_same_mesh(surfaces[structure], others[structure])


def assert_same_mesh(a, b) -> None:
    np.testing.assert_array_equal(a.vertices_mm, b.vertices_mm)
    np.testing.assert_array_equal(a.faces, b.faces)


def refits(frame: FrameFit) -> list:
    return [*frame.held_out.values(), *frame.members]


@pytest.mark.parametrize("method", ["muon", "adam"])
@pytest.mark.parametrize("rotate", [False, True])
def test_going_on_after_any_level_changes_nothing(
    study: ContourStudy, method: str, rotate: bool
) -> None:
    options = options_of(
        optimizer={"samples_per_step": 512, "method": method},
        alignment={"first_level": 0, "rotate": rotate},
    )
    kept = Kept()
    whole = reconstruct(study, options)
    assert_same(reconstruct(study, options, checkpoints=kept), whole)
    assert len(kept.saved[FIT]) == LEVELS
    assert any(slice_.shift_mm.any() for slice_ in whole.frames[0].slices)
    for after in kept.saved[FIT]:
        assert_same(reconstruct(study, options, checkpoints=Kept({FIT: after})), whole)


def test_an_attempt_that_goes_on_keeps_what_an_unbroken_one_keeps(study: ContourStudy) -> None:
    options, whole = options_of(), Kept()
    reconstruct(study, options, checkpoints=whole)
    first, *rest = whole.saved[FIT]
    resumed = Kept({FIT: first})
    reconstruct(study, options, checkpoints=resumed)
    assert resumed.saved[FIT] == rest


class StopsAt:
    """Asks to stop in a level, as a worker does that is told to close."""

    def __init__(self, level: int) -> None:
        self.level = level
        self.told: list[Progress] = []

    def advanced(self, progress: Progress) -> None:
        self.told.append(progress)

    def is_cancelled(self) -> bool:
        return bool(self.told) and (self.told[-1].level or 0) >= self.level


@pytest.mark.parametrize("level", [1, 2])
def test_a_stopped_fit_goes_on_from_the_level_before(study: ContourStudy, level: int) -> None:
    options, kept = options_of(), Kept()
    with pytest.raises(Cancelled):
        reconstruct(study, options, StopsAt(level), kept)
    assert len(kept.saved[FIT]) == level

    second = StopsAt(LEVELS)
    assert_same(reconstruct(study, options, second, kept), reconstruct(study, options))

    fitting = [p for p in second.told if p.stage is Stage.FITTING]
    assert fitting[0].is_taken_up
    assert fitting[0].level == level - 1
    assert not any(p.is_taken_up for p in fitting[1:])
    assert {p.level for p in fitting[1:]} == set(range(level, LEVELS))
    assert all(earlier.fraction <= later.fraction for earlier, later in pairwise(second.told))
    assert fitting[0].fraction > 0.2


def test_a_finished_fit_is_not_done_again(
    study: ContourStudy, monkeypatch: pytest.MonkeyPatch
) -> None:
    options, kept = options_of(holdout="leave_one_slice_out", ensemble=1), Kept()
    whole = reconstruct(study, options, checkpoints=kept)
    assert len(refits(whole.frames[0])) > 3
    sizes = [len(states) for states in kept.saved.values()]
    assert len(sizes) == 1 + len(refits(whole.frames[0])), "one place for every fit"

    def draw(*_: object) -> None:
        raise AssertionError("samples were drawn for a fit that is finished")

    monkeypatch.setattr(field_problem, "sample_level", draw)
    assert_same(reconstruct(study, options, checkpoints=kept), whole)


def test_frames_and_refits_that_were_finished_stay_so(
    study: ContourStudy, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The worker dies in the middle of the second frame of two."""
    (frame,) = study.frames
    both = study.model_copy(update={"frames": [frame, frame.model_copy(update={"label": "ES"})]})
    options, kept = options_of(ensemble=1), Kept()
    whole = reconstruct(both, options, checkpoints=kept)
    seed = options.seed + 1
    held = {key: kept.held[key] for key in (FIT, f"frame-ED-seed-{seed}")}
    half = Kept({**held, "frame-ES-fit": kept.saved["frame-ES-fit"][0]})
    assert_same(reconstruct(both, options, checkpoints=half), whole)
    assert half.saved.keys() == {"frame-ES-fit", f"frame-ES-seed-{seed}"}
    assert len(half.saved["frame-ES-fit"]) == LEVELS - 1


def test_a_finished_fit_keeps_no_optimiser(study: ContourStudy) -> None:
    kept = Kept()
    reconstruct(study, options_of(), checkpoints=kept)
    *_, before, last = kept.saved[FIT]
    assert len(last) < len(before)


def test_a_checkpoint_cannot_bring_code(study: ContourStudy) -> None:
    import io
    import pickle  # noqa: TID251 - names the error that unpickling nothing raises

    content = io.BytesIO()
    torch.save({"field": print}, content)
    with pytest.raises(pickle.UnpicklingError):
        reconstruct(study, options_of(), checkpoints=Kept({FIT: content.getvalue()}))
