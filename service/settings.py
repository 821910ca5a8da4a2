"""Settings of the HTTP API, from the environment (NEURALMRI_...)."""

from pydantic import Field, field_validator

from intake.settings import LimitSettings
from jobs.settings import JobSettings
from service.origins import OFF, parse_origins


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
