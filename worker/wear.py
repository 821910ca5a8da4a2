"""How many jobs this child process has worked on: after so many it is replaced.

Memory that a library never gives back goes with the process.
"""

from dataclasses import dataclass


@dataclass
class Wear:
    """Counted in each child by itself: a fork takes the parent's count along, which is 0."""

    jobs: int = 0

    def note_job(self) -> None:
        """One more attempt on a job has begun."""
        self.jobs += 1


OF_THIS_PROCESS = Wear()
