"""What a request says that it takes as an answer: RFC 9110, section 12.5.1."""

from fastapi import Request

from schemas.problem import InputError, ProblemType


def require_acceptable(request: Request, media_type: str) -> None:
    """Raise InputError (not acceptable, 406) where Accept excludes the media type."""
    accept = ",".join(request.headers.getlist("accept"))
    if not is_acceptable(accept, media_type):
        raise InputError(
            ProblemType.NOT_ACCEPTABLE,
            f"Accept excludes {media_type}. Remedy: send Accept: {media_type}.",
            status=406,
        )


def is_acceptable(accept: str, media_type: str) -> bool:
    """Whether an Accept header takes the media type; the most specific range decides.

    A header that is empty or not there takes everything, and so does a weight that is no number.
    """
    type_, _, _ = media_type.partition("/")
    ranges = dict.fromkeys((media_type, f"{type_}/*", "*/*"), -1.0)
    for part in accept.split(","):
        name, *parameters = (piece.strip().lower() for piece in part.split(";"))
        if name in ranges:
            ranges[name] = max(ranges[name], _weight(parameters))
    if not accept.strip():
        return True
    return next((weight > 0.0 for weight in ranges.values() if weight >= 0.0), False)


def _weight(parameters: list[str]) -> float:
    for parameter in parameters:
        name, _, value = parameter.partition("=")
        if name.strip() == "q":
            try:
                return max(0.0, float(value))
            except ValueError:
                return 1.0
    return 1.0
