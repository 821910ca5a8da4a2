"""POST /v1/validate/...: a submission judged, and nothing stored or queued."""

from fastapi import APIRouter

from intake.effort import effort
from intake.support import frame_surfaces
from schemas.options import Holdout
from schemas.validation import Validation
from service.access import Access
from service.contour_submission import CONTOUR_BODY, ContourUpload, judge_contours
from service.documented import problems
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
    judged = judge_contours(upload, access.settings.limits())
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
