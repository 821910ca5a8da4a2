"""Settings that service and worker share, from the environment: NEURALMRI_REDIS_URL and so on."""

import os
from pathlib import Path
from typing import Self

from pydantic import Field, model_validator
from pydantic_settings import (
    BaseSettings,
    PydanticBaseSettingsSource,
    SecretsSettingsSource,
    SettingsConfigDict,
)

from jobs.logs import LogFormat

SECRETS_DIR = "NEURALMRI_SECRETS_DIR"


class JobSettings(BaseSettings):
    """Where jobs are kept and how long anything about them may take. Read once a process."""

    model_config = SettingsConfigDict(env_prefix="NEURALMRI_", frozen=True, extra="ignore")

    redis_url: str = "redis://127.0.0.1:6379/0"
    data_dir: Path = Field(default=Path("data"), description="Job folders are in its `jobs`.")
    store_url: str | None = Field(
        default=None,
        pattern=r"^s3://[a-z0-9][a-z0-9.-]{1,61}[a-z0-9](/[A-Za-z0-9._/-]*)?$",
        description="A bucket for the job folders, `s3://bucket/prefix`; unset, `data_dir`.",
    )
    store_timeout_s: float = Field(
        default=10.0,
        gt=0.0,
        le=300.0,
        description="How long one connection to the bucket, or one silence of it, may take.",
    )
    redis_timeout_s: float = Field(default=2.0, gt=0.0, le=60.0)
    lease_s: float = Field(
        default=30.0, ge=1.0, le=3600.0, description="How long a worker may be silent about a job."
    )
    max_attempts: int = Field(
        default=3, ge=1, le=20, description="Lost workers after which a job fails."
    )
    soft_time_limit_s: int = Field(default=3600, ge=1)
    hard_time_limit_s: int = Field(default=3900, ge=2)
    lost_after_s: float = Field(
        default=30.0,
        gt=0.0,
        description="How long a job may lie with neither a lease nor a queue entry.",
    )
    reconcile_every_s: float = Field(default=60.0, gt=0.0)
    worker_alive_s: float = Field(
        default=30.0, gt=0.0, description="How old a live worker's last heartbeat may be."
    )

    log_format: LogFormat = Field(
        default=LogFormat.TEXT, description="json for machines, text for people."
    )

    @property
    def heartbeat_within_s(self) -> float:
        """How long ago the last finished heartbeat may be: one is asked for at half of it."""
        return 2 * self.worker_alive_s

    @property
    def jobs_dir(self) -> Path:
        return self.data_dir / "jobs"

    @property
    def visibility_timeout_s(self) -> int:
        """When the broker delivers an unacknowledged message again: never while a job may run."""
        return int(self.hard_time_limit_s * 1.1) + 60

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """After the environment, files of the folder in NEURALMRI_SECRETS_DIR, where that is set.

        A file has a variable's name in small letters, `neuralmri_redis_url`, and holds its value.
        Raises NotADirectoryError where the folder is none.
        """
        folder = os.environ.get(SECRETS_DIR)
        if not folder:
            return init_settings, env_settings
        if not Path(folder).is_dir():
            raise NotADirectoryError(f"{SECRETS_DIR} names no folder: {folder}; mount the secrets")
        return init_settings, env_settings, SecretsSettingsSource(settings_cls, folder)

    @model_validator(mode="after")
    def _limits_are_ordered(self) -> Self:
        if self.soft_time_limit_s >= self.hard_time_limit_s:
            raise ValueError("soft_time_limit_s must be below hard_time_limit_s")
        return self
