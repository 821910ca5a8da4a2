"""Celery's pool of children, each replaced once it has worked on so many jobs.

Celery's own count (`worker_max_tasks_per_child`) would take heartbeats for work: an idle worker
would throw its child away, and with it the libraries that the next job has to load anew.
"""

import sys
from typing import Any

from billiard.pool import EX_RECYCLE
from celery.concurrency import asynpool, prefork

from worker.app import settings
from worker.wear import OF_THIS_PROCESS


class _Child(asynpool.Worker):  # type: ignore[misc]  # celery ships no types
    """Leaves before it would wait for another task, where Celery's own count would end it too."""

    wait_for_job: Any

    def _make_child_methods(self, *arguments: Any) -> None:
        super()._make_child_methods(*arguments)
        wait_for_task = self.wait_for_job

        def wait_unless_worn() -> Any:
            if OF_THIS_PROCESS.jobs >= settings.max_tasks_per_child:
                sys.exit(EX_RECYCLE)
            return wait_for_task()

        self.wait_for_job = wait_unless_worn


class _Children(asynpool.AsynPool):  # type: ignore[misc]
    Worker = _Child


class JobPool(prefork.TaskPool):  # type: ignore[misc]
    """The prefork pool, with children that count jobs."""

    Pool = _Children
