"""Settings of the HTTP API, from the environment (NEURALMRI_...)."""

from pydantic import Field, field_validator

from intake.settings import LimitSettings
from jobs.settings import JobSettings
from service.origins import OFF, parse_origins
from service.tokens.settings import OidcSettings
from service.webhooks.settings import WebhookSettings


class ServiceSettings(OidcSettings, WebhookSettings, LimitSettings, JobSettings):
    """What the API needs beside the settings it shares with the workers. Read once a process."""

    body_within_s: float = Field(
        default=300.0, gt=0.0, le=3600.0, description="How long one body may take to arrive."
    )
    headers_within_s: float = Field(
        default=20.0,
        gt=0.0,
        le=600.0,
        description="How long a connection may take to say what it wants.",
    )
    require_keys: bool | None = Field(
        default=None, description="Whether to ask for API keys; None: once one exists."
    )
    audit_max_bytes: int = Field(
        default=16_777_216, ge=4096, description="Bytes of one file of the audit log."
    )
    audit_files: int = Field(
        default=8, ge=2, le=1000, description="Files kept of each kind, the newest among them."
    )
    poll_after_s: int = Field(
        default=2, ge=1, le=3600, description="What `Retry-After` tells a caller who polls a job."
    )
    max_queued_jobs: int = Field(
        default=1000, ge=1, description="Jobs that may wait for a worker, all owners together."
    )
    max_jobs_per_owner: int | None = Field(
        default=None,
        ge=1,
        description="Unfinished jobs of one owner; unset, no bound.",
    )
    max_batch_studies: int = Field(
        default=100, ge=1, le=1000, description="Studies of one batch, those that join included."
    )
    calls_per_minute: int = Field(
        default=6000, ge=0, le=10**6, description="Requests of one key, or address; 0: no limit."
    )
    submits_per_minute: int = Field(
        default=600, ge=0, le=10**6, description="Submissions of one key, or address; 0: no limit."
    )
    refusals_per_minute: int = Field(
        default=60,
        ge=0,
        le=10**6,
        description="Requests without a good key from one address that are told so; 0: no limit.",
    )
    retention_days: float | None = Field(
        default=None,
        gt=0.0,
        le=36525.0,
        description="How long jobs are kept after their end; unset, until somebody erases them.",
    )
    batch_turn_s: float = Field(
        default=600.0,
        ge=1.0,
        description="How often a batch job goes first while interactive jobs keep coming.",
    )
    retry_after_s: int = Field(
        default=10, ge=1, le=3600, description="What `Retry-After` tells a caller we had to fail."
    )
    cors_origins: str = Field(
        default=OFF,
        description="Origins whose pages may use the API, separated by spaces; exact ones only.",
    )

    @field_validator("cors_origins")
    @classmethod
    def _origins_are_exact(cls, text: str) -> str:
        parse_origins(text)
        return text

    @property
    def origins(self) -> tuple[str, ...]:
        """`cors_origins`, one by one."""
        return parse_origins(self.cors_origins)

    max_listeners: int = Field(
        default=200,
        ge=1,
        le=10_000,
        description="Event streams and held answers at a time, in one process.",
    )
    max_listeners_per_owner: int = Field(
        default=50, ge=1, le=10_000, description="Of them, those of one owner of keys."
    )
    event_heartbeat_s: float = Field(
        default=15.0, gt=0.0, le=300.0, description="How long an event stream may be silent."
    )
    max_wait_s: int = Field(
        default=60, ge=0, le=3600, description="The longest `Prefer: wait` that is granted."
    )
