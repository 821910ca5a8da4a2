"""What a job asks for, read from its folder: a contour study, wherever it came from."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from intake.limits import Limits
from jobs.folder import JobFolder
from schemas.labels import LabelRequest
from schemas.messages import ContourRequest
from schemas.options import Options
from schemas.study import ContourStudy
from schemas.vocabulary import View
from worker.labelmaps.reading import read_label_maps
from worker.provenance import label_maps_sha256, study_sha256


@dataclass(frozen=True)
class Reading:
    """A study and how it came about."""

    study: ContourStudy
    options: Options
    warnings: tuple[str, ...]
    input_sha256: str


def read_job(folder: JobFolder, limits: Limits) -> Reading:
    """Read a job's request and inputs. Raises JobGone, or InputError for unusable label maps."""
    request = folder.request()
    if request.contours is not None:
        return read_contours(request.contours)
    if request.labels is not None:
        files = {view: folder.input_path(name) for view, name in request.files.items()}
        return read_labels(files, request.labels, limits)
    raise ValueError(f"job {request.job_id} asks for nothing")


def read_contours(request: ContourRequest) -> Reading:
    """A contour study as sent."""
    return Reading(request.study, request.options, (), study_sha256(request.study))


def read_labels(files: Mapping[View, Path], request: LabelRequest, limits: Limits) -> Reading:
    """The contour study in a set of label maps. Raises InputError."""
    study, warnings = read_label_maps(files, request, limits)
    return Reading(study, request.options, tuple(warnings), label_maps_sha256(files, request))
