"""From job folders to messages: each end of a job becomes one message an endpoint that wants it.

The outcome in the folder is the event, whoever wrote it: a worker, the reconciler, or a
cancellation. A mark in the folder says that its messages are in the outbox. A crash
before it is there repeats the step, which finds the same messages under the same ids.
"""

import logging
from collections.abc import Callable
from datetime import UTC, datetime

from jobs.errors import JobGone
from jobs.folder import JobFolder
from jobs.store import JobStore
from schemas.messages import Outcome
from schemas.webhook import JobEvent
from service.webhooks.endpoint import Endpoint
from service.webhooks.endpoints import Endpoints
from service.webhooks.message import Message
from service.webhooks.outbox import Outbox

_LOGGER = logging.getLogger("neuralmri.webhooks")


class Announcer:
    """Looks for ends of jobs. It remembers those it need not look at again, to save time only.

    `traceparent` says which trace a job is part of; where it raises, the step is repeated later.
    """

    def __init__(
        self,
        store: JobStore,
        endpoints: Endpoints,
        outbox: Outbox,
        traceparent: Callable[[str], str | None] = lambda _job_id: None,
    ) -> None:
        self._store = store
        self._endpoints = endpoints
        self._outbox = outbox
        self._traceparent = traceparent
        self._settled: set[str] = set()

    def announce(self) -> None:
        """Put messages into the outbox for every job that has ended since the last time.

        An endpoint hears of jobs that finished after it was registered. What ends while it is
        disabled it does not hear of.
        """
        if not self._endpoints.all():
            return
        jobs = set(self._store.ids())
        self._settled &= jobs
        ended = [
            (folder, outcome)
            for job_id in sorted(jobs - self._settled)
            if (outcome := self._unannounced(folder := self._store.folder(job_id)))
        ]
        if not ended:
            return
        # Read after the outcomes: who is registered by now is told.
        endpoints = self._endpoints.all()
        for folder, outcome in ended:
            self._announce(folder, outcome, endpoints)
            self._settled.add(folder.job_id)

    def _unannounced(self, folder: JobFolder) -> Outcome | None:
        if folder.is_announced():
            self._settled.add(folder.job_id)
            return None
        try:
            return folder.outcome()
        except ValueError:
            # The reconciler says what is wrong with it; other jobs' ends are told all the same.
            self._settled.add(folder.job_id)
            return None

    def _announce(self, folder: JobFolder, outcome: Outcome, endpoints: list[Endpoint]) -> None:
        try:
            owner = folder.owner()
        except (JobGone, ValueError):  # erased, or damaged
            return
        told = [e for e in endpoints if e.owner == owner and e.created_at <= outcome.finished_at]
        if not told:
            return  # nor will anybody be: who registers later is told of later jobs
        event = JobEvent(f"job.{outcome.state}")
        traceparent = self._traceparent(folder.job_id)
        now = datetime.now(UTC)
        for endpoint in told:
            if endpoint.wants(event):
                message = Message.of_job(endpoint.id, folder.job_id, outcome, now, traceparent)
                self._outbox.add(endpoint.id, message)
        try:
            folder.mark_announced()
        except JobGone:
            _LOGGER.info("job %s was erased while its end was announced", folder.job_id)
