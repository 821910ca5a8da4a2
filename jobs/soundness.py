"""Whether a folder in the job store is a job: asked before anything is thought of it, and of no
other's sake than that one bad folder must not stand in the way of the good ones.
"""

import json
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel, ValidationError

from jobs.disk_folder import DiskFolder
from schemas.messages import JobRequest, Outcome

_FORMS: dict[str, type[BaseModel]] = {"request.json": JobRequest, "outcome.json": Outcome}


@dataclass(frozen=True)
class Fault:
    """Why a folder is no job to this release.

    is_damage: whether it can be none to any other either. A form that is only unknown here may be
    that of a newer release beside this one, and its jobs are none of ours to move.
    """

    why: str
    is_damage: bool = True


def fault_of(folder: DiskFolder) -> Fault | None:
    """What is wrong with a job's folder on a disk; None where it is sound, or gone.

    Raises OSError where the disk does not say.
    """
    if not folder.path.is_dir() or folder.path.is_symlink():
        return (
            Fault("it has the name of a job and is no folder") if _is_there(folder.path) else None
        )
    for name in _FORMS:
        fault = _fault_of_file(folder, name)
        if fault is not None:
            return fault if _is_there(folder.path) else None
    return None


def _fault_of_file(folder: DiskFolder, name: str) -> Fault | None:
    try:
        text = (folder.path / name).read_bytes()
    except FileNotFoundError:
        return Fault(f"it has no {name}") if name == "request.json" else None
    except IsADirectoryError:
        return Fault(f"its {name} is a folder")
    return fault_in(folder.job_id, name, text)


def fault_in(job_id: str, name: str, text: bytes) -> Fault | None:
    """What is wrong with a job's `request.json` or `outcome.json`; None where it is sound."""
    try:
        content = json.loads(text)
    except ValueError as error:
        return Fault(f"its {name} is damaged: {type(error).__name__} in {len(text)} bytes")
    if not isinstance(content, dict):
        return Fault(f"its {name} is damaged: it holds no object")
    if name == "request.json" and content.get("job_id") != job_id:
        return Fault(f"its {name} is of another job")
    try:
        _FORMS[name].model_validate_json(text)
    except ValidationError as error:
        return Fault(f"its {name} has {error.error_count()} fields unknown here", is_damage=False)
    return None


def _is_there(path: Path) -> bool:
    """Whether anything has this name; nothing has where the job was erased meanwhile."""
    try:
        path.lstat()
    except FileNotFoundError:
        return False
    return True
