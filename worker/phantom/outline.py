"""An outline as a curve: its length, points evenly along it, and an unsteady hand."""

import numpy as np

from worker.arrays import Points, SomePoints, Vector


def perimeter_mm(loop_mm: Points) -> float:
    """Length of the closed polyline through (k, 3) points."""
    return float(np.linalg.norm(np.roll(loop_mm, -1, axis=0) - loop_mm, axis=1).sum())


def enclosed_mm2(loop_mm: Points) -> float:
    """Area within a closed planar polyline of (k, 3) points."""
    doubled = np.cross(loop_mm, np.roll(loop_mm, -1, axis=0)).sum(axis=0)
    return float(np.linalg.norm(doubled) / 2.0)


def evenly_spaced(loop_mm: SomePoints, spacing_mm: float) -> SomePoints:
    """Points every `spacing_mm` (rounded to fit, at least 8) along a closed polyline, on it."""
    closed = np.vstack([loop_mm, loop_mm[:1]])
    length = np.concatenate([[0.0], np.linalg.norm(np.diff(closed, axis=0), axis=1).cumsum()])
    count = max(8, round(length[-1] / spacing_mm))
    at = np.arange(count) * (length[-1] / count)
    return np.column_stack([np.interp(at, length, closed[:, i]) for i in range(3)])


def unsteady(
    loop_mm: Points,
    normal: Vector,
    sd_mm: float,
    correlation_mm: float,
    generator: np.random.Generator,
) -> Points:
    """The outline as an observer's hand would draw it: every point moved in its plane by a random
    vector, `sd_mm` in either direction, that changes smoothly over `correlation_mm` of the curve.

    A vector, not an amount along the normal: the normal jumps at a corner, and such an outline
    would cross itself there.
    loop_mm: (k, 3), evenly spaced, closed. normal: unit normal of its plane.
    """
    if sd_mm == 0.0:
        return loop_mm
    count = len(loop_mm)
    cycles_per_mm = np.fft.rfftfreq(count, perimeter_mm(loop_mm) / count)
    gain = np.exp(-0.5 * (np.pi * cycles_per_mm * correlation_mm) ** 2)
    # The filter keeps only part of white noise's variance, its mean squared gain; this restores it.
    kept = np.mean(np.abs(np.fft.fft(np.fft.irfft(gain, count))) ** 2)
    white = np.fft.rfft(generator.normal(size=(3, count)), axis=1)
    moves = (np.fft.irfft(white * gain, count, axis=1) * (sd_mm / np.sqrt(kept))).T
    drawn: Points = loop_mm + moves - np.outer(moves @ normal, normal)
    return drawn
