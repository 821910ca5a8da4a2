"""The Celery application of the worker: `celery --app worker.app worker`.

The parent process takes messages and forks children; it never loads torch, which does not survive
a fork. A child works on one job at a time.
"""

import os
from typing import Any

from celery import Celery
from celery.signals import (
    celeryd_init,
    setup_logging,
    worker_init,
    worker_process_init,
    worker_process_shutdown,
    worker_shutting_down,
)

from jobs import spans
from jobs.celery_settings import celery_settings
from jobs.logs import write_logs
from worker import shutdown_flag
from worker.code_version import code_version
from worker.heartbeat import heartbeat_step
from worker.niceness import give_way, let_session_give_way
from worker.parent_death import die_with_parent
from worker.settings import WorkerSettings
from worker.threads import bind_libraries

settings = WorkerSettings()
# Here already, where whoever starts the worker reads it.
spans.require_extra()
# Before any child loads numpy, which looks at the environment only then.
bind_libraries(settings.threads)
code = code_version(settings.threads)

app = Celery("neuralmri-worker", include=["worker.task", "worker.heartbeat_task"])
app.conf.update(
    celery_settings(settings),
    worker_pool="worker.job_pool:JobPool",  # it heeds max_tasks_per_child
    # SIGQUIT's grace; on SIGTERM a job is handed back within a second or so.
    worker_soft_shutdown_timeout=10.0,
    # Control messages and events are broadcasts to everybody on the broker; nobody here needs them.
    worker_enable_remote_control=False,
    worker_send_task_events=False,
)
app.steps["consumer"].add(heartbeat_step(settings, code))


@celeryd_init.connect(weak=False)  # type: ignore[untyped-decorator]  # before Celery's first word
@setup_logging.connect(weak=False)  # type: ignore[untyped-decorator]  # in place of its own set-up
def _logs(**_: Any) -> None:
    write_logs(settings.log_format)


@worker_init.connect(weak=False)  # type: ignore[untyped-decorator]  # celery ships no types
def _opens(**_: Any) -> None:
    shutdown_flag.lower_flag()
    let_session_give_way(settings.nice)


@worker_shutting_down.connect(weak=False)  # type: ignore[untyped-decorator]
def _closes(**_: Any) -> None:
    shutdown_flag.raise_flag()


@worker_process_init.connect(weak=False)  # type: ignore[untyped-decorator]
def _child_starts(**_: Any) -> None:
    # A child that outlived its parent would hold a job that nobody can cancel.
    die_with_parent(os.getppid())
    # The parent stays as it is: it takes jobs and says that it is alive.
    give_way(settings.nice)
    spans.start("neuralmri-worker")


@worker_process_shutdown.connect(weak=False)  # type: ignore[untyped-decorator]
def _child_ends(**_: Any) -> None:
    spans.stop()
