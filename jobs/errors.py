"""Why a step on a job is refused, drawn in one place.

JobStepRefused
|-- AlreadyPublished   another attempt's results stand
|-- JobGone            the job's folder is not there: never was, or erased
|-- StaleToken         another attempt, a cancellation or an erasure has overtaken this token
`-- IllegalTransition  the lifecycle has no such step (a bug in the caller)

A store that fails is not a refusal: see `jobs/store_errors.py`.
"""


class JobStepRefused(Exception):  # noqa: N818 - the family reads as what happened, not as "Error"
    """A step on a job that must not be taken."""


class AlreadyPublished(JobStepRefused):
    """The job has results; the first publisher wins."""


class JobGone(JobStepRefused):
    """The job has no folder: stop working on it and leave nothing behind."""


class StaleToken(JobStepRefused):
    """The token is no longer the job's newest: stop working on it, write nothing more."""


class IllegalTransition(JobStepRefused):
    """The lifecycle does not allow this change of state."""
