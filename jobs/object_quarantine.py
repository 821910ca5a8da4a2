"""Where damaged jobs of a bucket go: out of the way, and never deleted.

quarantine/<job id>-<instant>/why.json       for whoever looks
                              request.json   and what else the job had, as it was found
"""

import json
import logging
from collections.abc import Iterable
from datetime import UTC, datetime

from jobs.bucket import Bucket
from jobs.object_folder import JOBS, REQUESTS
from jobs.soundness import Fault, fault_in
from jobs.store_errors import StoreUnavailable

_QUARANTINE = "quarantine/"

_LOGGER = logging.getLogger(__name__)


class ObjectQuarantine:
    """Within the same bucket: objects are copied first and deleted then."""

    def __init__(self, bucket: Bucket) -> None:
        self._bucket = bucket

    def set_aside(self, job_ids: Iterable[str]) -> tuple[str, ...]:
        """Move those that are damaged, and return their ids. What the bucket refuses is logged."""
        return tuple(job_id for job_id in job_ids if self._is_taken(job_id))

    def count(self) -> int:
        """How many there are. Raises StoreUnavailable."""
        return sum(1 for _ in self._bucket.folders(_QUARANTINE))

    def _is_taken(self, job_id: str) -> bool:
        try:
            fault = self._fault_of(job_id)
            if fault is None:
                return False
            if not fault.is_damage:
                _LOGGER.warning("job %s is left as it is: %s", job_id, fault.why)
                return False
            place = self._take(job_id, fault.why)
        except StoreUnavailable as error:
            _LOGGER.warning("job %s may be damaged, and cannot be moved: %s", job_id, error)
            return False
        _LOGGER.error("job %s was put into quarantine as %s: %s", job_id, place, fault.why)
        return True

    def _fault_of(self, job_id: str) -> Fault | None:
        request = self._bucket.get(f"{REQUESTS}{job_id}.json")
        if request is None:
            return None  # erased
        fault = fault_in(job_id, "request.json", request)
        if fault is not None:
            return fault
        outcome = self._bucket.get(f"{JOBS}{job_id}/outcome.json")
        return None if outcome is None else fault_in(job_id, "outcome.json", outcome)

    def _take(self, job_id: str, why: str) -> str:
        now = datetime.now(tz=UTC)
        place = f"{_QUARANTINE}{job_id}-{now:%Y%m%dT%H%M%S.%fZ}/"
        note = {"name": job_id, "at": f"{now:%FT%TZ}", "why": why}
        self._bucket.put(f"{place}why.json", json.dumps(note, indent=1).encode() + b"\n")
        request, home = f"{REQUESTS}{job_id}.json", f"{JOBS}{job_id}/"
        found = [listed.key for listed in self._bucket.under(home)]
        for key in found:
            self._bucket.copy(key, place + key.removeprefix(home))
        self._bucket.copy(request, f"{place}request.json")
        for key in (request, *found):
            self._bucket.delete(key)
        return place
