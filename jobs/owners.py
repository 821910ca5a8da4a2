"""Whose a job is, by its folder: known also without Redis, and asked with every request."""

from jobs.errors import JobGone
from jobs.folder import JobFolder

_REMEMBERED = 100_000


class JobOwners:
    """A job's owner never changes, so each folder is read once. Any thread may ask."""

    def __init__(self) -> None:
        self._known: dict[str, str] = {}

    def of(self, folder: JobFolder) -> str | None:
        """The owner's name; None for a job that is not there."""
        if not folder.exists():
            return None
        owner = self._known.get(folder.job_id)
        if owner is None:
            try:
                owner = folder.owner()
            except JobGone:
                return None
            if len(self._known) >= _REMEMBERED:
                self._known.clear()
            self._known[folder.job_id] = owner
        return owner
