"""Settings of the HTTP API, from the environment (NEURALMRI_...)."""

from pydantic import Field

from intake.limits import Limits
from jobs.settings import JobSettings


class ServiceSettings(JobSettings):
    """What the API needs beside the settings it shares with the workers. Read once a process."""

    max_request_bytes: int = Field(
        default=Limits.max_request_bytes,
        ge=1024,
        le=2**30,
        description="Bytes of one request's body, all parts together.",
    )
    poll_after_s: int = Field(
        default=2, ge=1, le=3600, description="What `Retry-After` tells a caller who polls a job."
    )
    retry_after_s: int = Field(
        default=10, ge=1, le=3600, description="What `Retry-After` tells a caller we had to fail."
    )

    def limits(self) -> Limits:
        return Limits(max_request_bytes=self.max_request_bytes)
