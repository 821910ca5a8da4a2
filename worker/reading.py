"""What a job asks for, read from its folder: a contour study, wherever it came from."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from intake.limits import Limits
from intake.study import admit
from jobs.folder import JobFolder
from schemas.labels import LabelRequest
from schemas.messages import ContourRequest, JobRequest
from schemas.options import Options
from schemas.study import ContourStudy
from schemas.vocabulary import View
from worker.labelmaps.reading import read_label_maps
from worker.provenance import label_maps_sha256, study_sha256, with_references_sha256
from worker.references import read_references
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True)
class Reading:
    """A study and how it came about.

    references: by surface (`ED_lv_endo`) what is taken for its truth, mm, in the study's own axes.
    input_sha256: of the study or label maps, and of the references where there are any.
    """

    study: ContourStudy
    options: Options
    warnings: tuple[str, ...]
    input_sha256: str
    references: Mapping[str, SurfaceMesh] = field(default_factory=dict)


def read_job(folder: JobFolder, limits: Limits, staging: Path) -> Reading:
    """Read a job's request and inputs, for the attempt whose folder is `staging`.

    Raises JobGone, or InputError for label maps or references that cannot be used.
    """
    request = folder.request()
    files = {
        surface: folder.local_input(name, staging) for surface, name in request.references.items()
    }
    return with_references(_read_study(folder, request, limits, staging), files, limits)


def _read_study(folder: JobFolder, request: JobRequest, limits: Limits, staging: Path) -> Reading:
    if request.contours is not None:
        return read_contours(request.contours)
    if request.labels is not None:
        files = {view: folder.local_input(name, staging) for view, name in request.files.items()}
        return read_labels(files, request.labels, limits)
    raise ValueError(f"job {request.job_id} asks for nothing")


def read_contours(request: ContourRequest) -> Reading:
    """A contour study as sent, with the warnings that came with it."""
    return Reading(
        request.study, request.options, tuple(request.warnings), study_sha256(request.study)
    )


def read_labels(files: Mapping[View, Path], request: LabelRequest, limits: Limits) -> Reading:
    """The contour study in a set of label maps. Raises InputError."""
    study, warnings = read_label_maps(files, request, limits)
    return Reading(study, request.options, tuple(warnings), label_maps_sha256(files, request))


def with_references(
    reading: Reading, files: Mapping[str, Path], limits: Limits, *, pointer: str = "/study"
) -> Reading:
    """The same, and the reference meshes that came with it, by surface; unchanged without any.

    `pointer` is where the study stands in what the caller sent. Raises InputError as `admit`, for
    which surfaces a study gives is only known of one that is sound, and as `read_references`.
    """
    if not files:
        return reading
    admit(reading.study, reading.options, limits, pointer=pointer)
    references, warnings = read_references(files, reading.study, reading.options, limits)
    return replace(
        reading,
        references=references,
        warnings=(*reading.warnings, *warnings),
        input_sha256=with_references_sha256(reading.input_sha256, files),
    )
