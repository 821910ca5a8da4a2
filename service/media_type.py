"""What a request says its body is."""

from fastapi import Request

from schemas.problem import InputError, ProblemType


def require_media_type(request: Request, *media_types: str) -> str:
    """Which of `media_types` the body is.

    Raises InputError (unsupported media type, 415) for a body of another type or encoding.
    """
    sent = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if sent not in media_types:
        raise InputError(
            ProblemType.UNSUPPORTED_MEDIA_TYPE,
            f"the body is {sent or 'of no media type'}. Remedy: send {' or '.join(media_types)}, "
            "and say so in Content-Type.",
            status=415,
        )
    if request.headers.get("content-encoding", "identity").lower() != "identity":
        raise InputError(
            ProblemType.UNSUPPORTED_MEDIA_TYPE,
            "the body has a Content-Encoding. Remedy: send it as it is; label maps may be .nii.gz.",
            status=415,
        )
    return sent
