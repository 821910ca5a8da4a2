"""Fits without a slice, and with other seeds: what they say about the first."""

import numpy as np
import pytest

from schemas.job import Progress, Stage
from schemas.options import Holdout, Options
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.evaluation.distance import points_to_surface_mm
from worker.evaluation.topology import is_watertight
from worker.observer import Cancelled
from worker.reconstruction.pipeline import reconstruct
from worker.reconstruction.result import FrameFit

ENDO, EPI = Structure.LV_ENDO, Structure.LV_EPI


def bumped(study: ContourStudy, name: str, factor: float) -> ContourStudy:
    """The study with the contours of one slice blown up about their middle."""
    document = study.model_dump(mode="json")
    for one in document["frames"][0]["slices"]:
        if one["id"] == name:
            for contour in one["contours"]:
                points = np.array(contour["points"])
                middle = points.mean(axis=0)
                contour["points"] = (middle + factor * (points - middle)).tolist()
    return ContourStudy.model_validate(document)


def held_out_error_mm(frame: FrameFit, name: str, structure: Structure) -> float:
    (one,) = [s for s in frame.slices if s.id == name]
    points = np.concatenate([one.aligned_mm(c.points_mm) for c in one.contours_mm[structure]])
    return float(points_to_surface_mm(points, frame.held_out[name][structure]).mean())


@pytest.mark.slow
def test_a_slice_that_was_left_out_is_not_remembered(concentric_spheres, quick: Options) -> None:
    """One slice is drawn a quarter too wide, 6 mm on the outer surface: a surface that knows it
    follows it at least in part, one that does not goes on as the sphere.
    """
    study = bumped(concentric_spheres(long_axis=False), "sax-05", 1.25)
    options = quick.model_copy(
        update={
            "holdout": Holdout.LEAVE_ONE_SLICE_OUT,
            "align_slices": False,
            "iterations_per_level": 120,
        }
    )
    (frame,) = reconstruct(study, options).frames
    (own,) = [s for s in frame.slices if s.id == "sax-05"]
    points = own.contours_mm[EPI][0].points_mm
    known = points_to_surface_mm(points, frame.surfaces[EPI]).mean()
    assert known < 2.0
    assert held_out_error_mm(frame, "sax-05", EPI) > 2.0 * known
    assert held_out_error_mm(frame, "sax-05", EPI) > 4.0


@pytest.mark.slow
def test_every_slice_is_left_out_once_and_spheres_hardly_change(
    concentric_spheres, quick: Options
) -> None:
    options = quick.model_copy(update={"holdout": Holdout.LEAVE_ONE_SLICE_OUT})
    (frame,) = reconstruct(concentric_spheres(), options).frames
    showing = [s.id for s in frame.slices if s.contours_mm]
    assert list(frame.held_out) == showing
    for name, surfaces in frame.held_out.items():
        assert all(is_watertight(mesh) for mesh in surfaces.values())
        for structure in surfaces:
            (one,) = [s for s in frame.slices if s.id == name]
            if structure in one.contours_mm:
                assert held_out_error_mm(frame, name, structure) < 2.5


def test_what_was_not_asked_for_is_not_fitted(concentric_spheres, quick: Options) -> None:
    (frame,) = reconstruct(concentric_spheres(), quick).frames
    assert not frame.held_out
    assert not frame.members


def test_an_ensemble_has_other_fits_of_the_same_heart(concentric_spheres, quick: Options) -> None:
    study = concentric_spheres()
    (frame,) = reconstruct(study, quick.model_copy(update={"ensemble": 2})).frames
    (plain,) = reconstruct(study, quick).frames
    np.testing.assert_array_equal(
        frame.surfaces[ENDO].vertices_mm, plain.surfaces[ENDO].vertices_mm
    )
    assert len(frame.members) == 2
    (second,) = reconstruct(study, quick.model_copy(update={"seed": 1})).frames
    np.testing.assert_array_equal(
        frame.members[0][ENDO].vertices_mm, second.surfaces[ENDO].vertices_mm
    )
    first, other = (m[ENDO].vertices_mm for m in frame.members)
    assert first.shape != other.shape or not np.array_equal(first, other)


def test_refits_are_told_as_such_and_can_be_stopped(concentric_spheres, quick: Options) -> None:
    class Stopping:
        """Asks to stop at the first word of a refit."""

        def __init__(self) -> None:
            self.seen: list[Progress] = []

        def advanced(self, progress: Progress) -> None:
            self.seen.append(progress)

        def is_cancelled(self) -> bool:
            return any(one.stage is Stage.REFITTING for one in self.seen)

    watcher = Stopping()
    options = quick.model_copy(update={"holdout": Holdout.LEAVE_ONE_SLICE_OUT})
    with pytest.raises(Cancelled):
        reconstruct(concentric_spheres(), options, watcher)
    fractions = [one.fraction for one in watcher.seen]
    assert fractions == sorted(fractions)
    assert watcher.seen[-1].stage is Stage.REFITTING
    # A dozen refits of half a fit each: the first fit is a small part of the work.
    assert fractions[-1] < 0.25
