"""Job folders in a bucket, for services and workers that share no disk."""

import secrets
from collections.abc import Collection
from datetime import UTC, datetime, timedelta

from jobs.bucket import Bucket
from jobs.object_folder import JOBS, REQUESTS, ObjectFolder
from jobs.object_quarantine import ObjectQuarantine
from jobs.scratch import Scratch
from jobs.store import JobIds, checked_job_id, is_job_id
from jobs.store_errors import StoreMisfit, StoreUnavailable

_ABANDONED_AFTER = timedelta(hours=1)
_PROBES = "probes/"


class ObjectStore:
    """All job folders of a bucket. `scratch` is where attempts keep files on this machine."""

    def __init__(self, bucket: Bucket, scratch: Scratch) -> None:
        self.bucket = bucket
        self._scratch = scratch
        self._ids = JobIds()

    def new_id(self) -> str:
        return self._ids.new()

    def folder(self, job_id: str) -> ObjectFolder:
        return ObjectFolder(self.bucket, self._scratch, checked_job_id(job_id))

    def ids(self) -> list[str]:
        names = (listed.key.removeprefix(REQUESTS) for listed in self.bucket.under(REQUESTS))
        return [name[:-5] for name in names if name.endswith(".json") and is_job_id(name[:-5])]

    def gone(self, job_ids: Collection[str]) -> set[str]:
        # One listing, not a question a job: the bucket may be far away.
        return set(job_ids).difference(self.ids())

    def set_aside(self, suspects: Collection[str]) -> tuple[str, ...]:
        return ObjectQuarantine(self.bucket).set_aside(sorted(suspects))

    def quarantined(self) -> int:
        return ObjectQuarantine(self.bucket).count()

    def prove(self) -> None:
        """Whether the bucket can be written and refuses a second writer."""
        probe = f"{_PROBES}{secrets.token_hex(6)}"
        try:
            if self.bucket.put_new(probe, b"first") and self.bucket.put_new(probe, b"second"):
                raise StoreMisfit(
                    "the store takes no heed of If-None-Match on PUT, so two workers could both "
                    "end one job: use one that does"
                )
            self.bucket.delete(probe)
        except StoreMisfit:
            raise
        except StoreUnavailable:
            return

    def trouble(self) -> str | None:
        probe = f"{_PROBES}{secrets.token_hex(6)}"
        try:
            self.bucket.put(probe, b"x")
            self.bucket.delete(probe)
        except StoreUnavailable as error:
            return error.reason
        return None

    def space(self) -> None:
        """Without a bound; raises StoreUnavailable where it does not answer."""
        self.bucket.exists(f"{_PROBES}none")

    def sweep(self) -> None:
        """Delete what has lain for an hour without a request: an erasure or submission cut short,
        or the late word of a worker that was killed right after it.
        """
        before = datetime.now(tz=UTC) - _ABANDONED_AFTER
        shown = set(self.ids())
        for job_id in list(self.bucket.folders(JOBS)):
            if job_id in shown:
                continue
            left = list(self.bucket.under(f"{JOBS}{job_id}/"))
            # It may have been shown since it was listed.
            if all(listed.modified_at < before for listed in left) and not (
                self.folder(job_id).exists()
            ):
                for listed in left:
                    self.bucket.delete(listed.key)
        for listed in list(self.bucket.under(_PROBES)):
            if listed.modified_at < before:
                self.bucket.delete(listed.key)
