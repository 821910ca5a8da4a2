"""The frames of a reconstruction, measured one by one: of several, one that fails fails alone."""

from collections.abc import Mapping

from schemas.frame_report import FailedFrameReport, FrameReport
from schemas.job import Progress, Stage
from schemas.options import Options
from schemas.problem import InternalError
from schemas.surface_name import SurfaceName
from schemas.vocabulary import Structure
from worker.artifacts.frame_report import measured_frame
from worker.artifacts.measured import MeasuredFrame
from worker.observer import Observer
from worker.reconstruction.result import FrameFit, Reconstruction
from worker.surface_mesh import SurfaceMesh


def measured_frames(
    reconstruction: Reconstruction,
    options: Options,
    references: Mapping[str, SurfaceMesh],
    observer: Observer,
) -> tuple[list[tuple[FrameReport, MeasuredFrame]], list[FailedFrameReport]]:
    """Those that could be measured, and those that failed before or here.

    references: by surface (`ED_lv_endo`). observer: told of each frame before it is measured.
    Raises as `measured_frame` does where no frame is left.
    """
    measured, errors = [], []
    failed = [FailedFrameReport(label=f.label, reason=f.reason) for f in reconstruction.failed]
    for index, fit in enumerate(reconstruction.frames):
        done = index / len(reconstruction.frames)
        observer.advanced(Progress(stage=Stage.MEASURING, frame=fit.label, fraction=done))
        try:
            measured.append(measured_frame(fit, options, _of(fit, references), observer))
        except InternalError as error:
            failed.append(FailedFrameReport(label=fit.label, reason=error.detail))
            errors.append(error)
    if errors and not measured:
        raise errors[0]
    return measured, failed


def _of(fit: FrameFit, references: Mapping[str, SurfaceMesh]) -> dict[Structure, SurfaceMesh]:
    named = {structure: str(SurfaceName(fit.label, structure)) for structure in fit.surfaces}
    return {s: references[name] for s, name in named.items() if name in references}
