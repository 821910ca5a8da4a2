"""Finding among the folders of a disk what is no job, and putting it into quarantine: one bad
folder costs no other job anything, and nobody's data is deleted for looking odd.
"""

import logging
from collections.abc import Iterable
from pathlib import Path

from jobs.disk_folder import DiskFolder
from jobs.quarantine import Quarantine
from jobs.soundness import fault_of

_LOGGER = logging.getLogger(__name__)


def set_aside(
    quarantine: Quarantine, strangers: Iterable[Path], suspects: Iterable[DiskFolder]
) -> tuple[str, ...]:
    """Move folders of no job's name, and of `suspects` those that are damaged.

    A suspect that is sound, or of a form that is only unknown to this release, stays. Returns the
    names of what was moved. What the disk refuses is logged, and tried again in the next round.
    """
    found = [(path, "its name is no job's") for path in strangers]
    for folder in suspects:
        try:
            fault = fault_of(folder)
        except OSError as error:
            _LOGGER.warning("the folder of job %s cannot be read: %s", folder.job_id, error)
            continue
        if fault is None:
            continue
        if fault.is_damage:
            found.append((folder.path, fault.why))
        else:
            _LOGGER.warning("job %s is left as it is: %s", folder.job_id, fault.why)
    return tuple(path.name for path, why in found if _take(quarantine, path, why))


def _take(quarantine: Quarantine, path: Path, why: str) -> bool:
    try:
        place = quarantine.take(path, why)
    except OSError as error:
        _LOGGER.warning("%s is no job and cannot be moved (%s): %s", path.name, why, error)
        return False
    if place is not None:
        _LOGGER.error("%s was put into quarantine as %s: %s", path.name, place.name, why)
    return place is not None
