"""The body of a contour submission, from bytes to an admitted request."""

from intake.json_body import parse_json
from intake.limits import Limits
from intake.study import DEFAULT_LIMITS, admit
from schemas.messages import ContourRequest


def read_contour_request(
    raw: bytes, limits: Limits = DEFAULT_LIMITS
) -> tuple[ContourRequest, list[str]]:
    """The request in `raw`, and warnings about its study.

    Raises:
        InputError: 400, 413 or 422, with the JSON pointer of the offending part.
    """
    request = parse_json(raw, ContourRequest, limits)
    return request, admit(request.study, request.options, limits)
