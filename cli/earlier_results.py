"""Results that are there already, on a server or in a folder, and what they say of themselves."""

import re
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from schemas.problem import InputError, ProblemType
from schemas.report import Report

_JOB = re.compile(r"(https?://.+)/v1/jobs/([0-9a-f]{32})/?")
_MESHES = (".stl", ".obj", ".ply", ".vtp", ".glb", ".pvd")
_HEAD_BYTES = 8192
_SAID_JOB = re.compile(rb"job_id\W{1,8}([0-9a-f]{32})")


@dataclass(frozen=True)
class EarlierResults:
    """A folder of artifacts and the report among them.

    job_id: of the job that made them, as their meshes say; None where none did.
    """

    folder: Path
    report: Report
    job_id: str | None

    def names(self) -> list[str]:
        """Of every artifact: files that a run leaves, the manifest aside."""
        return sorted(
            path.name
            for path in self.folder.iterdir()
            if path.suffix in _MESHES or path.name in ("report.json", "report.html")
        )


def job_at(text: str) -> tuple[str, str] | None:
    """Server and id where the text is the address of a job."""
    found = _JOB.fullmatch(text)
    return (found[1], found[2]) if found else None


def results_in(folder: Path) -> EarlierResults:
    """Raises InputError where the folder holds no results, or those of another version."""
    path = folder / "report.json"
    if not path.is_file():
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"there is no {path}; name a folder of results, or a job by its address, as in "
            "http://127.0.0.1:8000/v1/jobs/...",
        )
    try:
        report = Report.model_validate_json(path.read_bytes())
    except ValidationError as error:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"{path} is no report of this version ({error.error_count()} places differ); rerun it "
            "with the version that its `provenance` names",
        ) from error
    return EarlierResults(folder, report, _job_id(folder))


def check_whole(report: Report) -> None:
    """Raises InputError where the results are what a cancelled job had finished."""
    if report.stopped_early:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "these results are of a job that was stopped before all frames were finished, and that "
            "cannot be done again; restart the job, or reconstruct the study, and rerun that",
        )


def _job_id(folder: Path) -> str | None:
    for path in sorted(folder.iterdir()):
        if path.suffix in _MESHES:
            with path.open("rb") as file:
                found = _SAID_JOB.search(file.read(_HEAD_BYTES))
            if found:
                return found[1].decode()
    return None
