"""Settings of a worker process, from the environment: NEURALMRI_THREADS and so on."""

from pydantic import Field

from intake.settings import LimitSettings
from jobs.settings import JobSettings


class WorkerSettings(LimitSettings, JobSettings):
    """What a worker needs beyond what it shares with the service. Read once a process."""

    threads: int = Field(
        default=1,
        ge=1,
        le=256,
        description="Threads of one job. One is fastest when workers fill the cores, and the count "
        "changes the last digits of a result.",
    )
    processes: int = Field(
        default=1,
        ge=1,
        le=64,
        description="Processes of one job, that many frames of a study at a time; the bytes of a "
        "result are the same.",
    )
    max_tasks_per_child: int = Field(
        default=20, ge=1, description="Jobs after which a child process is replaced."
    )
    nice: int = Field(
        default=5,
        ge=0,
        le=19,
        description="How far computing gives way to other processes on the same cores.",
    )
    store_patience_s: float = Field(
        default=300.0,
        ge=0.0,
        description="How long a finished attempt waits for a store that does not answer.",
    )
    heartbeat_every_s: float = Field(default=5.0, gt=0.0, le=15.0)
