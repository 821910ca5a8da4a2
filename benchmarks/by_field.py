"""This project's method: all surfaces of a frame in one fit."""

from benchmarks.found import Found
from schemas.options import Options, Preset
from schemas.study import ContourStudy
from worker.reconstruction.pipeline import reconstruct
from worker.threads import use_threads


def fast(study: ContourStudy) -> Found:
    """Preset fast."""
    return _fitted(study, Options(preset=Preset.FAST))


def standard(study: ContourStudy) -> Found:
    """Preset standard."""
    return _fitted(study, Options(preset=Preset.STANDARD))


def unaligned(study: ContourStudy) -> Found:
    """Preset standard with every slice taken to be in place."""
    return _fitted(study, Options(preset=Preset.STANDARD, align_slices=False))


def paper(study: ContourStudy) -> Found:
    """Preset paper."""
    return _fitted(study, Options(preset=Preset.PAPER))


def _fitted(study: ContourStudy, options: Options) -> Found:
    use_threads(1)
    frame = reconstruct(study, options).frames[0]
    shifts = {s.id: s.shift_mm for s in frame.slices} if options.align_slices else {}
    return Found(frame.surfaces, shifts)
