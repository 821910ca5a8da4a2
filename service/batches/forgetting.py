"""Erasing the records of batches whose jobs have all expired: an id and names, and no study."""

from datetime import UTC, datetime, timedelta

from service.access import JobAccess
from service.batches.joining import member_ids


class ForgottenBatches:
    """Any number of processes may do this at any time: a record is erased once or not at all."""

    def __init__(self, access: JobAccess) -> None:
        self._access = access

    def erase_empty(self, now: datetime | None = None) -> int:
        """Erase records as old as jobs may become, and of which no job is left; say how many.

        None where jobs are kept for ever. `now` is the present, if it is not to be asked for.
        """
        access, days = self._access, self._access.settings.retention_days
        if days is None:
            return 0
        oldest = (now or datetime.now(tz=UTC)) - timedelta(days=days)
        erased = 0
        for batch_id in access.batches.ids():
            record = access.batches.read(batch_id)
            if record is None or record.created_at > oldest or record.pending:
                continue
            if not any(
                access.store.folder(job_id).exists() for job_id in member_ids(access, record)
            ):
                access.batches.erase(batch_id)
                erased += 1
        return erased
