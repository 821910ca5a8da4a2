"""Settings of the HTTP API, from the environment (NEURALMRI_...)."""

from pydantic import Field

from intake.settings import LimitSettings
from jobs.settings import JobSettings


class ServiceSettings(LimitSettings, JobSettings):
    """What the API needs beside the settings it shares with the workers. Read once a process."""

    body_within_s: float = Field(
        default=300.0, gt=0.0, le=3600.0, description="How long one body may take to arrive."
    )
    poll_after_s: int = Field(
        default=2, ge=1, le=3600, description="What `Retry-After` tells a caller who polls a job."
    )
    retry_after_s: int = Field(
        default=10, ge=1, le=3600, description="What `Retry-After` tells a caller we had to fail."
    )
    max_listeners: int = Field(
        default=200,
        ge=1,
        le=10_000,
        description="Event streams and held answers at a time, in one process.",
    )
    event_heartbeat_s: float = Field(
        default=15.0, gt=0.0, le=300.0, description="How long an event stream may be silent."
    )
    max_wait_s: int = Field(
        default=60, ge=0, le=3600, description="The longest `Prefer: wait` that is granted."
    )
