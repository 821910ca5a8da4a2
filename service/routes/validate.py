"""POST /v1/validate/...: a submission judged, and nothing stored or queued."""

from fastapi import APIRouter

from intake.effort import effort
from intake.support import frame_surfaces
from schemas.options import Holdout
from schemas.validation import Validation
from service.access import Access
from service.contour_submission import (
    CONTOUR_BODY,
    ContourUpload,
    JudgedContours,
    judge_contours,
)
from service.documented import problems
from service.file_submission import FILES_BODY, FilesUpload, judge_files
from service.label_submission import LABEL_BODY, LabelUpload, judge_labels

router = APIRouter(tags=["submit"])

_PROBLEMS = problems(400, 413, 415, 422)


@router.post(
    "/v1/validate/contours", status_code=200, responses=_PROBLEMS, openapi_extra=CONTOUR_BODY
)
def validate_contours(upload: ContourUpload, access: Access) -> Validation:
    """Judge a contour study as a submission would, and keep nothing.

    Neither queue nor store is asked. What would be refused is refused with the same problem.
    """
    return _validation(judge_contours(upload, access.settings.limits()))


@router.post("/v1/validate/files", status_code=200, responses=_PROBLEMS, openapi_extra=FILES_BODY)
def validate_files(upload: FilesUpload, access: Access) -> Validation:
    """Read contour files and judge their study as a submission would, and keep nothing.

    What was guessed, mended or left out in reading them is among the warnings.
    """
    return _validation(judge_files(upload, access.settings.limits()))


def _validation(judged: JudgedContours) -> Validation:
    study, options = judged.request.study, judged.request.options
    made = {frame.label: frame_surfaces(frame, options) for frame in study.frames}
    return Validation(
        surfaces={label: surfaces for label, surfaces in made.items() if surfaces},
        warnings=judged.warnings,
        effort_fits=effort(study, options),
    )


@router.post("/v1/validate/labels", status_code=200, responses=_PROBLEMS, openapi_extra=LABEL_BODY)
def validate_labels(upload: LabelUpload, access: Access) -> Validation:
    """Judge label maps as a submission would, and keep nothing.

    That is their headers and sizes: which surfaces they give, a worker finds out, who may yet
    refuse them (`unknown-labels`, `wrong-label-scheme`, `empty-label-map`, `mismatched-views`).
    """
    judged = judge_labels(upload, access.settings.limits())
    options = judged.request.options
    counted = options.holdout is Holdout.NONE
    return Validation(
        surfaces=None,
        warnings=[],
        effort_fits=judged.frames * (1.0 + options.ensemble) if counted else None,
    )
