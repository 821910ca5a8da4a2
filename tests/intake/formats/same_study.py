"""Whether two studies outline the same, whatever their slices are called."""

import numpy as np

from schemas.study import ContourStudy, Frame


def outlines(frame: Frame) -> list[tuple[str, bool, np.ndarray]]:
    found = [
        (c.structure.value, c.closed, np.array(c.points)) for s in frame.slices for c in s.contours
    ]
    return sorted(found, key=lambda one: (one[0], tuple(one[2].mean(axis=0).round(3))))


def assert_same_outlines(one: ContourStudy, other: ContourStudy, tolerance_mm: float) -> None:
    assert len(one.frames) == len(other.frames)
    for a, b in zip(one.frames, other.frames, strict=True):
        ours, theirs = outlines(a), outlines(b)
        assert [x[:2] for x in ours] == [x[:2] for x in theirs]
        for (_, _, p), (_, _, q) in zip(ours, theirs, strict=True):
            np.testing.assert_allclose(p, q, atol=tolerance_mm)


def assert_on_planes(study: ContourStudy, tolerance_mm: float) -> None:
    """Every point lies on the plane that its slice gives."""
    for frame in study.frames:
        for s in frame.slices:
            for c in s.contours:
                off = (np.array(c.points) - np.array(s.origin)) @ np.array(s.normal)
                assert np.abs(off).max() < tolerance_mm
