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
from worker.checkpoints import Checkpoints, Unkept
from worker.crew import Crew, Part
from worker.observer import Observer
from worker.reconstruction.result import FrameFit, Reconstruction
from worker.surface_mesh import SurfaceMesh


def measured_frames(
    reconstruction: Reconstruction,
    options: Options,
    references: Mapping[str, SurfaceMesh],
    observer: Observer,
    crew: Crew,
) -> tuple[list[tuple[FrameReport, MeasuredFrame]], list[FailedFrameReport]]:
    """Those that could be measured, and those that failed before or here.

    references: by surface (`ED_lv_endo`). Raises as `measured_frame` does where no frame is left.
    """
    measured, errors = [], []
    failed = [FailedFrameReport(label=f.label, reason=f.reason) for f in reconstruction.failed]
    parts = [Part(_measured, (fit, options, _of(fit, references))) for fit in reconstruction.frames]
    for fit, found in zip(
        reconstruction.frames, crew.all_of(parts, observer, Unkept()), strict=True
    ):
        if isinstance(found, InternalError):
            failed.append(FailedFrameReport(label=fit.label, reason=found.detail))
            errors.append(found)
        else:
            report, frame = found
            measured.append((report, frame.with_meshes(fit.surfaces)))
    if errors and not measured:
        raise errors[0]
    return measured, failed


def _measured(
    fit: FrameFit,
    options: Options,
    references: Mapping[Structure, SurfaceMesh],
    observer: Observer,
    _: Checkpoints,
) -> tuple[FrameReport, MeasuredFrame] | InternalError:
    observer.advanced(Progress(stage=Stage.MEASURING, frame=fit.label))
    try:
        return measured_frame(fit, options, references, observer)
    except InternalError as error:
        return error


def _of(fit: FrameFit, references: Mapping[str, SurfaceMesh]) -> dict[Structure, SurfaceMesh]:
    named = {structure: str(SurfaceName(fit.label, structure)) for structure in fit.surfaces}
    return {s: references[name] for s, name in named.items() if name in references}
