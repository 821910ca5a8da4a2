"""What can go wrong, drawn in one place: RFC 9457 problems and the errors that carry them.

ServiceError
|-- InputError      the caller's fault: 4xx, or a job that failed with an input error
`-- InternalError   ours: 5xx, or a job that failed and may be tried again
"""

from enum import StrEnum
from typing import Any

from pydantic import Field

from schemas.base import WireModel


class Fault(StrEnum):
    """Whose it is to mend."""

    CALLER = "caller"
    SERVICE = "service"


class ProblemType(StrEnum):
    """Stable names of problems. The value is the last part of the problem's `type`."""

    # requests
    MALFORMED_JSON = "malformed-json"
    INVALID_REQUEST = "invalid-request"
    UNAUTHENTICATED = "unauthenticated"
    MISSING_SCOPE = "missing-scope"
    NOT_FOUND = "not-found"
    METHOD_NOT_ALLOWED = "method-not-allowed"
    NOT_ACCEPTABLE = "not-acceptable"
    UNSUPPORTED_MEDIA_TYPE = "unsupported-media-type"
    TOO_LARGE = "too-large"
    NOT_READY = "not-ready"
    UNSATISFIABLE_RANGE = "unsatisfiable-range"
    IDEMPOTENCY_KEY_REUSED = "idempotency-key-reused"
    IDEMPOTENCY_KEY_PENDING = "idempotency-key-pending"
    TOO_MANY_JOBS = "too-many-jobs"
    BATCH_REFUSED = "batch-refused"
    RATE_LIMITED = "rate-limited"
    TOO_MANY_LISTENERS = "too-many-listeners"
    WEBHOOK_TARGET_REFUSED = "webhook-target-refused"
    WEBHOOK_DISABLED = "webhook-disabled"
    CROSS_ORIGIN = "cross-origin"
    INPUTS_NOT_SERVED = "inputs-not-served"
    # contour studies
    OFF_PLANE_POINTS = "off-plane-points"
    DEGENERATE_CONTOUR = "degenerate-contour"
    SELF_CROSSING_CONTOUR = "self-crossing-contour"
    UNCLOSED_CONTOUR = "unclosed-contour"
    IMPLAUSIBLE_SIZE = "implausible-size"
    TOO_FEW_SLICES = "too-few-slices"
    UNSUPPORTED_SURFACE = "unsupported-surface"
    CROSSING_STRUCTURES = "crossing-structures"
    CONTRADICTING_SLICES = "contradicting-slices"
    # contour files of other programs
    UNREADABLE_CONTOUR_FILE = "unreadable-contour-file"
    # label maps
    UNREADABLE_LABEL_MAP = "unreadable-label-map"
    UNSUPPORTED_LABEL_MAP = "unsupported-label-map"
    AMBIGUOUS_VOXEL_SIZE = "ambiguous-voxel-size"
    INVALID_AFFINE = "invalid-affine"
    UNKNOWN_LABELS = "unknown-labels"
    WRONG_LABEL_SCHEME = "wrong-label-scheme"
    EMPTY_LABEL_MAP = "empty-label-map"
    MISMATCHED_VIEWS = "mismatched-views"
    # ours
    NO_SURFACE = "no-surface"
    TIMED_OUT = "timed-out"
    WORKER_LOST = "worker-lost"
    UNAVAILABLE = "unavailable"
    QUEUE_FULL = "queue-full"
    STORE_UNAVAILABLE = "store-unavailable"
    STORAGE_FULL = "storage-full"
    INTERNAL = "internal"

    @property
    def uri(self) -> str:
        return f"urn:neuralmri:problem:{self.value}"


class ProblemPart(WireModel):
    """One offending place of a request."""

    pointer: str = Field(description="JSON pointer into the request, or the name of a file part.")
    detail: str


class Problem(WireModel):
    """An RFC 9457 problem document."""

    type: str
    title: str
    status: int = Field(ge=400, le=599)
    detail: str = Field(description="What is wrong, and what to do about it.")
    fault: Fault
    instance: str | None = None
    pointer: str | None = Field(default=None, description="JSON pointer to the offending part.")
    errors: list[ProblemPart] = Field(default_factory=list)
    trace_id: str | None = Field(
        default=None, description="Under which the service's log has the request."
    )


class ServiceError(Exception):
    """An expected failure. `detail` is a sentence that names the remedy.

    retry_after_s: when to send the same request again, where that can be told.
    """

    fault: Fault
    default_status: int

    def __init__(
        self,
        type_: ProblemType,
        detail: str,
        *,
        pointer: str | None = None,
        status: int | None = None,
        errors: list[ProblemPart] | None = None,
        retry_after_s: int | None = None,
    ) -> None:
        super().__init__(detail)
        self.type = type_
        self.detail = detail
        self.pointer = pointer
        self.status = status or self.default_status
        self.errors = errors or []
        self.retry_after_s = retry_after_s

    def __reduce__(self) -> tuple[Any, ...]:
        # `args` is the detail alone, and would not make it again in another process.
        return _again, (type(self), self.args), self.__dict__

    def problem(self, instance: str | None = None) -> Problem:
        return Problem(
            type=self.type.uri,
            title=self.type.value.replace("-", " ").capitalize(),
            status=self.status,
            detail=self.detail,
            fault=self.fault,
            instance=instance,
            pointer=self.pointer,
            errors=self.errors,
        )


def _again(kind: type[ServiceError], args: tuple[Any, ...]) -> ServiceError:
    return kind.__new__(kind, *args)


class InputError(ServiceError):
    """The caller's fault; sending the same again will fail again."""

    fault = Fault.CALLER
    default_status = 422


class InternalError(ServiceError):
    """Our fault; the same request may succeed later."""

    fault = Fault.SERVICE
    default_status = 500
