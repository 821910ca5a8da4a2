"""What an S3-compatible server, or the way to it, says when it takes no step."""

from collections.abc import Iterator
from contextlib import contextmanager

import aiohttp
from botocore.exceptions import BotoCoreError, NoCredentialsError, PartialCredentialsError

from jobs.store_errors import StoreMisfit, StoreUnavailable

_NO_KEY = {"NoSuchKey"}
_TAKEN = {"PreconditionFailed", "412"}
_CONFLICT = {"ConditionalRequestConflict", "OperationAborted", "409"}
_MISFIT = {
    "NoSuchBucket": "the bucket of NEURALMRI_STORE_URL does not exist",
    "AccessDenied": "the store refuses these credentials the right (AccessDenied)",
    "403": "the store refuses these credentials the right (403)",
    "InvalidAccessKeyId": "the store does not know AWS_ACCESS_KEY_ID",
    "SignatureDoesNotMatch": "AWS_SECRET_ACCESS_KEY is not the key's",
    "ExpiredToken": "AWS_SESSION_TOKEN has expired",
    "InvalidToken": "AWS_SESSION_TOKEN is not valid",
    "NotImplemented": "the store does not know a request that this needs (NotImplemented)",
}


class NoSuchObject(Exception):  # noqa: N818 - what happened
    """There is nothing under this key."""


class Taken(Exception):  # noqa: N818
    """There is something under this key already."""


class Conflict(Exception):  # noqa: N818
    """Another request on this key was under way; it is to be sent again."""


@contextmanager
def answers() -> Iterator[None]:
    """Raise what a request failed of as one of the above, StoreMisfit or StoreUnavailable."""
    try:
        yield
    except (NoCredentialsError, PartialCredentialsError) as error:
        raise StoreMisfit(
            "there are no credentials for the store: set AWS_ACCESS_KEY_ID and "
            "AWS_SECRET_ACCESS_KEY, or give the machine a role"
        ) from error
    except (OSError, BotoCoreError, aiohttp.ClientError) as error:
        code = _code(error)
        if code in _NO_KEY:
            raise NoSuchObject from error
        if code in _TAKEN:
            raise Taken from error
        if code in _CONFLICT:
            raise Conflict from error
        if code in _MISFIT:
            raise StoreMisfit(_MISFIT[code]) from error
        raise StoreUnavailable(f"the store does not answer ({code})") from error


def _code(error: BaseException) -> str:
    """The server's word for it; where it said none, the name of what went wrong on the way."""
    cause = error.__cause__ or error
    answer = getattr(cause, "response", None)
    if isinstance(answer, dict):
        return str(answer.get("Error", {}).get("Code", type(cause).__name__))
    return type(cause).__name__
