"""Results of jobs as members of an archive: `<folder>/<artifact>`."""

import re
from collections.abc import Iterable, Iterator, Sequence
from fnmatch import fnmatchcase

from jobs.folder import JobFolder
from schemas.artifacts import MANIFEST_NAME, Manifest
from schemas.base import FOLDER_NAME_PATTERN
from schemas.problem import InputError, ProblemType
from service.zip_stream import ZipMember, chunks_of

PATTERN = r"^[A-Za-z0-9._*?-]{1,160}$"

_SAFE = re.compile(FOLDER_NAME_PATTERN)


def archive_folders(named: Iterable[tuple[str, str | None]]) -> dict[str, str]:
    """What the folder of each job is called, by its id: its name, where that is fit and its own.

    `named` are ids and names. No two folders differ by the case of letters alone, since not every
    disk tells such apart. A job without a name has its id.
    """
    taken: set[str] = set()
    folders: dict[str, str] = {}
    for job_id, name in named:
        fit = [name, f"{name}-{job_id}"] if name and _SAFE.fullmatch(name) else []
        folder = next(text for text in [*fit, job_id] if text.lower() not in taken)
        taken.add(folder.lower())
        folders[job_id] = folder
    return folders


def wanted(manifest: Manifest, patterns: Sequence[str]) -> list[str]:
    """Names of the artifacts that one of the patterns fits; all, manifest included, without any."""
    names = [*(artifact.name for artifact in manifest.artifacts), MANIFEST_NAME]
    if not patterns:
        return names
    return [name for name in names if any(fnmatchcase(name, pattern) for pattern in patterns)]


def archived(
    folder: JobFolder, manifest: Manifest, below: str, names: Sequence[str]
) -> Iterator[ZipMember]:
    """The job's artifacts as members. Raises JobGone where it is erased under our hands."""
    for name in names:
        file = folder.artifact(name)
        yield ZipMember(f"{below}{name}", file.bytes, manifest.created_at, chunks_of(file.open()))


def nothing_fits() -> InputError:
    """The answer where no artifact is of the name asked for."""
    return InputError(
        ProblemType.NOT_FOUND,
        "no artifact fits `artifact`. Remedy: list the names at the job's `artifacts`, or leave "
        "the parameter out to have all.",
        pointer="/query/artifact",
        status=404,
    )
