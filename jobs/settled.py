"""Jobs that need nothing more: their folder and their record agree on how they ended."""

from collections.abc import Sequence

from jobs.records import JobRecords
from schemas.job import JobState


class Settled:
    """Remembers them from round to round, so that a round costs what is unfinished and not what
    was ever done. One a process, for one thread.

    An outcome is written once, so one that agreed is not read again while its folder is listed and
    Redis says the same. A Redis that went back or forgot says something else.
    """

    def __init__(self) -> None:
        self._ends: dict[str, JobState] = {}
        self._states: dict[str, JobState | None] = {}

    def left(self, job_ids: Sequence[str], records: JobRecords) -> list[str]:
        """Those of the listed jobs that are to be looked at. Raises RedisError."""
        self._states = dict(zip(job_ids, records.states(job_ids), strict=True))
        self._ends = {id_: end for id_, end in self._ends.items() if id_ in self._states}
        return [
            id_
            for id_, state in self._states.items()
            if state is None or self._ends.get(id_) is not state
        ]

    def note(self, job_id: str) -> None:
        """Folder and record of a job that was left were found to agree."""
        state = self._states[job_id]
        if state is not None and state.is_terminal:
            self._ends[job_id] = state
