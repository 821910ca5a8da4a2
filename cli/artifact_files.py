"""All artifacts of a job, or some, into a folder."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from cli.connection import Connection, refused
from cli.fitting import fitting
from cli.transfer import fetch
from schemas.artifacts import MANIFEST_NAME, Manifest
from schemas.problem import InputError, ProblemType


def fetch_artifacts(
    connection: Connection, address: str, out: Path, names: Sequence[str] = ()
) -> Manifest:
    """Fetch into `out` what is at `address`, all or those named, and check length and SHA-256.

    A file takes its place only once it is whole; one that is there already is not fetched. What a
    broken line left is taken up again. Raises InternalError for a file that arrives damaged,
    InputError for a name that the job does not have.
    """
    manifest = fitting(Manifest, connection.call("GET", address))
    listed = {artifact.name: artifact for artifact in manifest.artifacts}
    unknown = [name for name in names if name not in listed]
    if unknown:
        raise InputError(
            ProblemType.NOT_FOUND,
            f"the job has no artifact {unknown[0]}; it has {', '.join(listed)}",
        )
    out.mkdir(parents=True, exist_ok=True)
    for name in names or listed:
        connection.fetch(
            partial(
                fetch,
                path=f"{address}/{name}",
                artifact=listed[name],
                out=out,
                refusal=refused,
            )
        )
    if not names:
        text = manifest.model_dump_json(indent=1)
        (out / MANIFEST_NAME).write_text(text, encoding="utf-8")
    return manifest
